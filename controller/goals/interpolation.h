// Smooth motion to a goal from whatever motion is under way. All members may be called in the
// cycle.
#pragma once

#include "common/types.h"
#include "controller/kinds/pose.h"

namespace limber::controller {

/// x(t) from (x0, v0, a0) at t = 0 to (x1, 0, 0) at t = T along one polynomial of degree five, and
/// at rest from then on. From rest this is the minimum-jerk motion 10 s^3 - 15 s^4 + 6 s^5 (Flash
/// and Hogan 1985) with peak speed 1.875 |x1 - x0| / T; from a motion it continues without a jump
/// in position, velocity or acceleration.
template <typename Vector>
class QuinticMotion {
 public:
  /// At rest at x.
  explicit QuinticMotion(const Vector& rest)
      : x(rest), v(0.0 * rest), a(v), end_(rest), d_(v), v0_(v), a0_(v) {}

  /// Continues from the present (x, v, a) to rest at `end`, T > 0.
  void start(const Vector& end, double T) noexcept {
    d_ = x - end;
    v0_ = v * T;
    a0_ = a * T * T;
    end_ = end;
    T_ = T;
    elapsed_ = 0.0;
  }

  /// To rest in T, wherever that is: the velocity falls to zero along a cubic.
  void stop(double T) noexcept { start(x + 0.5 * T * v + (T * T / 12.0) * a, T); }

  /// At rest at x at once.
  void reset(const Vector& rest) noexcept { *this = QuinticMotion(rest); }
  /// In this motion now, at the end of it: as another's that leads it.
  void follow(const Vector& now, const Vector& rate, const Vector& rate_rate) noexcept {
    reset(now);
    v = rate;
    a = rate_rate;
  }

  void advance(double dt) noexcept {
    if (!moving()) return;
    elapsed_ += dt;
    if (elapsed_ > T_ - kRounding) elapsed_ = T_;
    const double s = elapsed_ / T_;
    const double s2 = s * s;
    const double s3 = s2 * s;
    x = end_ + (1.0 - s3 * (10.0 - 15.0 * s + 6.0 * s2)) * d_ +
        s * (1.0 - s2 * (6.0 - 8.0 * s + 3.0 * s2)) * v0_ +
        0.5 * s2 * (1.0 - s * (3.0 - 3.0 * s + s2)) * a0_;
    v = (-30.0 * s2 * (1.0 - 2.0 * s + s2) / T_) * d_ +
        ((1.0 - s2 * (18.0 - 32.0 * s + 15.0 * s2)) / T_) * v0_ +
        ((s - 0.5 * s2 * (9.0 - 12.0 * s + 5.0 * s2)) / T_) * a0_;
    const double T2 = T_ * T_;
    a = (-60.0 * s * (1.0 - 3.0 * s + 2.0 * s2) / T2) * d_ +
        (-s * (36.0 - 96.0 * s + 60.0 * s2) / T2) * v0_ +
        ((1.0 - s * (9.0 - 18.0 * s + 10.0 * s2)) / T2) * a0_;
  }

  bool moving() const noexcept { return elapsed_ < T_; }
  const Vector& end() const noexcept { return end_; }
  double left_s() const noexcept { return T_ - elapsed_; }

  Vector x;  ///< present value
  Vector v;  ///< its rate
  Vector a;  ///< the rate's rate

 private:
  // Many small steps do not add up to T exactly; what is left of the motion then is nothing.
  static constexpr double kRounding = 1e-9;

  Vector end_;
  Vector d_;
  Vector v0_;
  Vector a0_;
  double T_ = 0.0;
  double elapsed_ = 0.0;
};

/// A circle from rest: the rate of turn rises smoothly (minimum jerk) over the first period.
struct CircleMotion {
  /// Through `start`, about `axis` (unit) at `centre`, one turn in `period_s`.
  CircleMotion(const Eigen::Vector3d& start, const Eigen::Vector3d& centre,
               const Eigen::Vector3d& axis, double period_s) noexcept;

  /// Position, velocity and acceleration `t` seconds after the start.
  void at(double t, Eigen::Vector3d* x, Eigen::Vector3d* v, Eigen::Vector3d* a) const noexcept;

  Eigen::Vector3d centre;
  Eigen::Vector3d axis;
  Eigen::Vector3d radius;  ///< from the centre to the start, normal to the axis
  double period_s;
};

/// The same for a pose: position along the polynomial; rotation R(t) = Exp(r(t)) R1 with the
/// rotation vector r along the polynomial to zero. From rest this is the geodesic, the shortest
/// turn about one fixed axis.
class PoseMotion {
 public:
  PoseMotion();

  void reset(const Pose& rest) noexcept;
  void start(const Pose& end, double T) noexcept;
  /// Round and round, without turning, until start() or stop().
  void circle(const Eigen::Vector3d& centre, const Eigen::Vector3d& axis, double period_s) noexcept;
  void stop(double T) noexcept;
  /// In this motion now, at the end of it: as another's that leads it.
  void follow(const Pose& X, const Vector6& V, const Vector6& A) noexcept;
  void advance(double dt) noexcept;
  bool moving() const noexcept { return circling_ || position_.moving(); }

  /// Where the motion ends.
  Pose end() const noexcept;

  Pose X_BD;
  Vector6 V_BD = Vector6::Zero();
  Vector6 A_BD = Vector6::Zero();

 private:
  void update() noexcept;

  QuinticMotion<Eigen::Vector3d> position_;
  QuinticMotion<Eigen::Vector3d> rotation_;  // r: from the base orientation to the present one
  Eigen::Quaterniond base_;
  CircleMotion circle_;
  double circling_s_ = 0.0;
  bool circling_ = false;
};

}  // namespace limber::controller
