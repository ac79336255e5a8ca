// The goal along a target stream: its knots' curve, and what is left of earlier ones.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "controller/goals/stream/bounded_follower.h"
#include "controller/goals/stream/knot_path.h"

namespace limber::controller {

/// rad/s, rad/s^2 (m, N for prismatic joints and translations), an entry each.
template <typename Vector>
struct StreamBounds {
  Vector v_fade, a_fade;  ///< of what is left of an earlier curve
  Vector v_max, a_max;    ///< of the goal
};

/// Where knots change the curve, the difference from the old one fades to zero along a quintic, in
/// position, velocity and acceleration:
///   T = max(0.15 s, what is left of an earlier fade, 1.875 d / v_fade, sqrt(5.77 d / a_fade)),
/// d: how far the curve jumps. The sum goes through a BoundedFollower. All members may be called in
/// the cycle.
template <typename Space>
class StreamMotion {
 public:
  using Point = typename Space::Point;
  using Vector = typename Space::Vector;

  explicit StreamMotion(const StreamBounds<Vector>& bounds)
      : bounds_(bounds),
        path_(bounds.v_max, bounds.a_max),
        fade_(Vector(0.0 * bounds.v_max)),
        follower_(bounds.v_max, bounds.a_max) {}

  const StreamBounds<Vector>& bounds() const noexcept { return bounds_; }
  bool active() const noexcept { return !path_.empty(); }
  /// Without knots, at this point, at arm time `now_ns` of the last cycle.
  void reset(const Point& present, std::int64_t now_ns) noexcept {
    path_.clear();
    reference_ = present;
    follower_.reset(present);
    last_ns_ = now_ns;
  }

  /// After a cycle and before the next. False: no room for so many knots.
  bool take(std::span<const Knot<Space>> knots) noexcept {
    const Point old = path_at(last_ns_);
    if (!path_.replace(knots)) return false;
    join(old);
    return true;
  }

  /// `v_up`, `v_down`: bounds of this cycle in either direction. There must be a knot.
  void advance(std::int64_t now_ns, double dt_s, const Vector& v_up,
               const Vector& v_down) noexcept {
    // After missed cycles the goal goes on from where it was.
    const Point old = path_at(last_ns_ + std::llround(1e9 * dt_s));
    const bool gap = std::abs(1e-9 * static_cast<double>(now_ns - last_ns_) - dt_s) > 1e-6;
    last_ns_ = now_ns;
    fade_.advance(dt_s);
    if (gap) {
      reference_ = Space::compose({fade_.x, fade_.v, fade_.a}, old);
      join(old);
    }
    path_.forget(now_ns);
    reference_ = Space::compose({fade_.x, fade_.v, fade_.a}, path_.at(now_ns));
    follower_.advance(reference_, v_up, v_down, dt_s);
  }

  const Point& goal() const noexcept { return follower_.out(); }
  bool bounded() const noexcept { return follower_.behind(); }
  std::int64_t last_ns() const noexcept { return path_.last_ns(); }
  /// Of the curve, `time_ns` not before now; before the first knot where the goal is.
  Point path_at(std::int64_t time_ns) const noexcept {
    return active() ? path_.at(time_ns) : reference_;
  }

 private:
  static constexpr double kShortestFade_s = 0.15;

  /// The reference goes on where it is; the curve is now another than `old` was.
  void join(const Point& old) noexcept {
    const Point fresh = path_.at(last_ns_);
    const double T =
        std::max({kShortestFade_s, fade_.left_s(), fade_time(Space::relative(old, fresh).x)});
    const Rates<Vector> left = Space::relative(reference_, fresh);
    fade_.reset(left.x);
    // Of knots that jump: what is too fast to be faded is the follower's to smooth.
    fade_.v = clamped<Space>(left.v, 2.0 * bounds_.v_max);
    fade_.a = clamped<Space>(left.a, 2.0 * bounds_.a_max);
    fade_.start(Vector(0.0 * left.x), T);
  }

  double fade_time(const Vector& jump) const noexcept {
    double longest = 0.0;
    for (Eigen::Index i = 0; i < jump.size(); i += Space::kBlock) {
      const double d = jump.template segment<Space::kBlock>(i).norm();
      longest = std::max(
          {longest, 1.875 * d / bounds_.v_fade[i], std::sqrt(5.77 * d / bounds_.a_fade[i])});
    }
    return longest;
  }

  StreamBounds<Vector> bounds_;
  KnotPath<Space> path_;
  QuinticMotion<Vector> fade_;
  Point reference_;
  BoundedFollower<Space> follower_;
  std::int64_t last_ns_ = 0;
};

}  // namespace limber::controller
