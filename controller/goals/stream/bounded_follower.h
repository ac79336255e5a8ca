// Follows a reference within bounds of velocity and acceleration.
#pragma once

#include <algorithm>
#include <cmath>

#include "controller/goals/stream/stream_space.h"

namespace limber::controller {

/// As long as the reference keeps the bounds it is followed exactly. Where it does not:
///   v_r = clamp(v_d + omega/2 e),  a = clamp(a_d + 2 omega (v_r - v)),  e from here to it,
/// critically damped with omega = 50 1/s where nothing is clamped, until it is caught up with.
/// All members may be called in the cycle.
template <typename Space>
class BoundedFollower {
 public:
  using Point = typename Space::Point;
  using Vector = typename Space::Vector;

  /// Greatest velocity and acceleration, an entry each; blocks of Space::kBlock by their length.
  BoundedFollower(const Vector& v_max, const Vector& a_max) : v_max_(v_max), a_max_(a_max) {}

  void reset(const Point& at) noexcept {
    out_ = at;
    behind_ = false;
  }

  /// `v_up`, `v_down`: bounds of this cycle in either direction, at most those of construction.
  const Point& advance(const Point& reference, const Vector& v_up, const Vector& v_down,
                       double dt_s) noexcept {
    behind_ = behind_ || !within(reference, v_up, v_down);
    if (!behind_) {
      out_ = reference;
      return out_;
    }
    const Rates<Vector> away = Space::relative(Space::at_rest(reference.x), at_rest());
    Vector wish = reference.v + 0.5 * kRate_per_s * away.x;
    wish = clamped<Space>(wish, v_max_).cwiseMin(v_up).cwiseMax(-v_down);
    const Vector rate = reference.a + 2.0 * kRate_per_s * (wish - out_.v);
    const Vector next =
        clamped<Space>(Vector(out_.v + dt_s * rate), v_max_).cwiseMin(v_up).cwiseMax(-v_down);
    const Vector a = clamped<Space>(Vector((next - out_.v) / dt_s), a_max_);
    const Vector way = dt_s * (out_.v + 0.5 * dt_s * a);
    out_.x = Space::compose({way, 0.0 * a, 0.0 * a}, at_rest()).x;
    out_.v += dt_s * a;
    out_.a = a;
    const Rates<Vector> left = Space::relative(Space::at_rest(reference.x), at_rest());
    behind_ = !(within(reference, v_up, v_down) && left.x.norm() < kCaughtUp &&
                (reference.v - out_.v).norm() < kRate_per_s * kCaughtUp);
    return out_;
  }

  const Point& out() const noexcept { return out_; }
  /// A bound acts.
  bool behind() const noexcept { return behind_; }

 private:
  static constexpr double kRate_per_s = 50.0;
  static constexpr double kCaughtUp = 1e-6;  // rad or m

  Point at_rest() const noexcept { return Space::at_rest(out_.x); }

  bool within(const Point& point, const Vector& v_up, const Vector& v_down) const noexcept {
    return clamped<Space>(point.v, v_max_) == point.v &&
           clamped<Space>(point.a, a_max_) == point.a && (v_up - point.v).minCoeff() >= 0.0 &&
           (v_down + point.v).minCoeff() >= 0.0;
  }

  Vector v_max_, a_max_;
  Point out_;
  bool behind_ = false;
};

}  // namespace limber::controller
