// The smooth curve through knots with times.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "controller/goals/interpolation.h"
#include "controller/goals/stream/derivative_weights.h"
#include "controller/goals/stream/stream_space.h"

namespace limber::controller {

template <typename Space>
struct Knot {
  std::int64_t time_ns = 0;
  typename Space::Value x;
};

/// Between two knots a polynomial of degree five with velocity and acceleration at its ends from
/// the knots around (knot_point()): position, velocity and acceleration are continuous. Before the
/// first knot and after the last the curve comes from rest and to rest within max(kBrake, v /
/// a_max). All members may be called in the cycle.
template <typename Space>
class KnotPath {
 public:
  using Point = typename Space::Point;
  using Vector = typename Space::Vector;
  static constexpr int kMost = 256;
  /// Knots nearer than this are one.
  static constexpr std::int64_t kClosest_ns = 1'000'000;
  /// Knots further apart than this do not belong together.
  static constexpr std::int64_t kGap_ns = 500'000'000;

  /// Most velocity and acceleration at a knot, whatever its neighbours, and of the deceleration
  /// after the last one, an entry each: knots that jump do not make the curve swing.
  KnotPath(const Vector& v_max, const Vector& a_max) : v_max_(v_max), a_max_(a_max) {}

  bool empty() const noexcept { return count_ == 0; }
  void clear() noexcept { count_ = 0; }
  std::int64_t last_ns() const noexcept { return knot(count_ - 1).time_ns; }

  /// These replace every knot at or after the time of their first. False: no room, and nothing
  /// has changed. `knots`: at least one, with rising times.
  bool replace(std::span<const Knot<Space>> knots) noexcept {
    int kept = count_;
    while (kept > 0 && knot(kept - 1).time_ns + kClosest_ns > knots.front().time_ns) --kept;
    if (kept > 0 && knots.front().time_ns - knot(kept - 1).time_ns > kGap_ns) kept = 0;
    if (kept + static_cast<int>(knots.size()) > kMost) return false;
    count_ = kept;
    for (const Knot<Space>& next : knots) knot(count_++) = next;
    return true;
  }

  /// Leaves out what the curve from `now` on does not depend on.
  void forget(std::int64_t now_ns) noexcept {
    while (count_ > 3 && knot(3).time_ns <= now_ns) {
      first_ = (first_ + 1) % kMost;
      --count_;
    }
  }

  /// There must be a knot.
  Point at(std::int64_t now_ns) const noexcept {
    if (now_ns <= knot(0).time_ns) return coming(seconds(knot(0).time_ns - now_ns));
    if (now_ns >= last_ns()) return leaving(seconds(now_ns - last_ns()));
    int i = 0;
    while (knot(i + 1).time_ns <= now_ns) ++i;
    return between(i, seconds(now_ns - knot(i).time_ns));
  }

  /// The curve does not move from `now` on.
  bool at_rest(std::int64_t now_ns) const noexcept {
    return now_ns >= last_ns() && seconds(now_ns - last_ns()) >= brake_time(knot_point(count_ - 1));
  }

 private:
  static constexpr double kBrake_s = 0.25;
  static constexpr double kPeak = 1.5;  // of the deceleration along a cubic, over its mean

  static double seconds(std::int64_t ns) noexcept { return 1e-9 * static_cast<double>(ns); }
  const Knot<Space>& knot(int i) const noexcept {
    return knots_[static_cast<std::size_t>((first_ + i) % kMost)];
  }
  Knot<Space>& knot(int i) noexcept {
    return knots_[static_cast<std::size_t>((first_ + i) % kMost)];
  }

  /// The knot with its velocity and acceleration: those of the polynomial through it and its
  /// neighbours, two on either side if they are there, else one, at the ends the nearest two.
  Point knot_point(int i) const noexcept {
    const Point here = Space::at_rest(knot(i).x);
    const bool five = i >= 2 && i + 2 < count_;
    const int nodes = five ? 5 : std::min(count_, 3);
    const int first = five ? i - 2 : std::clamp(i - 1, 0, count_ - nodes);
    std::array<double, 5> times{};
    for (int k = 0; k < nodes; ++k)
      times[static_cast<std::size_t>(k)] = seconds(knot(first + k).time_ns - knot(i).time_ns);
    const DerivativeWeights weights = derivative_weights(std::span(times).first(nodes));
    Point point = here;
    for (int k = 0; k < nodes; ++k) {
      const Vector way = Space::relative(Space::at_rest(knot(first + k).x), here).x;
      point.v += weights.first[static_cast<std::size_t>(k)] * way;
      point.a += weights.second[static_cast<std::size_t>(k)] * way;
    }
    point.v = clamped<Space>(point.v, v_max_);
    point.a = clamped<Space>(point.a, a_max_);
    return point;
  }
  double step(int i) const noexcept { return seconds(knot(i + 1).time_ns - knot(i).time_ns); }

  /// The parabola that leaves the next knot backwards is taken off; what is left ends at rest.
  Point between(int i, double t) const noexcept {
    const double T = step(i);
    const Point base = Space::at_rest(knot(i).x);
    const Rates<Vector> from = Space::relative(knot_point(i), base);
    const Rates<Vector> to = Space::relative(knot_point(i + 1), base);
    QuinticMotion<Vector> rest(Vector(0.0 * to.x));
    rest.x = from.x - to.x + T * to.v - 0.5 * T * T * to.a;
    rest.v = from.v - to.v + T * to.a;
    rest.a = from.a - to.a;
    rest.start(Vector(0.0 * to.x), T);
    rest.advance(t);
    const double s = t - T;
    return Space::compose(
        {rest.x + to.x + s * to.v + 0.5 * s * s * to.a, rest.v + to.v + s * to.a, rest.a + to.a},
        base);
  }

  double brake_time(const Point& point) const noexcept {
    return std::max(kBrake_s, kPeak * point.v.cwiseAbs().cwiseQuotient(a_max_).maxCoeff());
  }

  Point leaving(double t) const noexcept { return stopping(knot_point(count_ - 1), t, 1.0); }
  Point coming(double t) const noexcept { return stopping(knot_point(0), t, -1.0); }

  /// From the point to rest, forwards or backwards in time.
  Point stopping(const Point& point, double t, double direction) const noexcept {
    const Point base = Space::at_rest(point.x);
    const Rates<Vector> from = Space::relative(point, base);
    QuinticMotion<Vector> stop(from.x);
    stop.v = direction * from.v;
    stop.a = from.a;
    stop.stop(brake_time(point));
    stop.advance(t);
    return Space::compose({stop.x, direction * stop.v, stop.a}, base);
  }

  Vector v_max_, a_max_;
  std::array<Knot<Space>, kMost> knots_;
  int first_ = 0;
  int count_ = 0;
};

}  // namespace limber::controller
