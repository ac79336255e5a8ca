// What moves along a target stream, the joints or the tip, as one kind of thing.
#pragma once

#include "common/types.h"
#include "controller/kinds/pose.h"

namespace limber::controller {

/// Position, velocity and acceleration in a vector space.
template <typename Vector>
struct Rates {
  Vector x, v, a;
};

/// A position with its velocity and acceleration; `Value` at rest is {value, 0, 0}.
/// A space has relative(), the motion of one point as another that moves sees it, and compose(),
/// its inverse. All members may be called in the cycle.
struct JointSpace {
  using Vector = VectorJ;
  using Value = VectorJ;
  static constexpr int kBlock = 1;  ///< limits hold for each joint
  struct Point {
    Value x;
    Vector v, a;
  };
  static Point at_rest(const Value& x) noexcept;
  static Rates<Vector> relative(const Point& point, const Point& from) noexcept;
  static Point compose(const Rates<Vector>& motion, const Point& from) noexcept;
};

/// Twists and accelerations as in Goal: base axes, linear first. A relative motion is the
/// difference of positions, and the rotation vector r of Q = Exp(r) Q_from:
///   omega = omega_r + R_r omega_from
///   alpha = alpha_r + R_r alpha_from + omega_r x R_r omega_from,  omega_r = J_l(r) r'.
struct TipSpace {
  using Vector = Vector6;
  using Value = Pose;
  static constexpr int kBlock = 3;  ///< for the length of translation and rotation
  struct Point {
    Value x;
    Vector v, a;
  };
  static Point at_rest(const Value& x) noexcept;
  static Rates<Vector> relative(const Point& point, const Point& from) noexcept;
  static Point compose(const Rates<Vector>& motion, const Point& from) noexcept;
};

/// Each block of `x` shortened to the length `most` has there. In the cycle.
template <typename Space>
typename Space::Vector clamped(typename Space::Vector x,
                               const typename Space::Vector& most) noexcept {
  for (Eigen::Index i = 0; i < x.size(); i += Space::kBlock) {
    auto block = x.template segment<Space::kBlock>(i);
    const double length = block.norm();
    if (length > most[i]) block *= most[i] / length;
  }
  return x;
}

}  // namespace limber::controller
