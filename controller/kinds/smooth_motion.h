// Motion from rest to rest with four continuous derivatives.
#pragma once

#pragma GCC visibility push(default)
namespace limber::controller {

/// x(t) = x0 + (x1 - x0) p(t / T),  p(s) = 126 s^5 - 420 s^6 + 540 s^7 - 315 s^8 + 70 s^9:
/// velocity, acceleration, jerk and snap are zero at both ends; peak speed 2.4609 |x1 - x0| / T.
/// For actuators whose command contains the fourth derivative of the link's motion (De Luca 2000).
/// All members may be called in the cycle.
template <typename Vector>
class SmoothMotion {
 public:
  static constexpr double kPeak = 315.0 / 128.0;

  /// At rest at x.
  explicit SmoothMotion(const Vector& rest)
      : x(rest), v(0.0 * rest), a(v), jerk(v), snap(v), start_(rest), way_(v) {}

  void start(const Vector& from, const Vector& end, double T) noexcept {
    *this = SmoothMotion(from);
    way_ = end - from;
    T_ = T;
  }

  void advance(double dt) noexcept {
    if (!moving()) return;
    elapsed_ += dt;
    if (elapsed_ > T_ - kRounding) elapsed_ = T_;
    const double s = elapsed_ / T_;
    const double r = 1.0 - s;
    const double s2 = s * s;
    const double r2 = r * r;
    x = start_ +
        s2 * s2 * s * (126.0 + s * (-420.0 + s * (540.0 + s * (-315.0 + s * 70.0)))) * way_;
    v = 630.0 * s2 * s2 * r2 * r2 / T_ * way_;
    a = 2520.0 * s2 * s * r2 * r * (1.0 - 2.0 * s) / (T_ * T_) * way_;
    jerk = 2520.0 * s2 * r2 * (3.0 - 14.0 * s * r) / (T_ * T_ * T_) * way_;
    snap = 15120.0 * s * r * (1.0 - 7.0 * s * r) * (1.0 - 2.0 * s) / (T_ * T_ * T_ * T_) * way_;
  }

  /// From now on at rest where it is.
  void end() noexcept { elapsed_ = T_; }
  bool moving() const noexcept { return elapsed_ < T_; }

  Vector x;
  Vector v;
  Vector a;
  Vector jerk;
  Vector snap;

 private:
  static constexpr double kRounding = 1e-9;

  Vector start_;
  Vector way_;
  double T_ = 0.0;
  double elapsed_ = 0.0;
};

}  // namespace limber::controller
#pragma GCC visibility pop
