// How the width between a hand's fingers goes with the angle of its motor.
//
//   w(theta) piecewise linear through the table, with its end pieces going on beyond the ends
//   virtual work:  F w' = tau theta'   so   tau = F dw/dtheta
//
// F is what each of two fingers presses with: both move by half of w.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace limber {

/// m and rad (a hand on a screw: m and m). A value; every member is allowed in the cycle.
struct HandTravel {
  static constexpr std::size_t kMostPoints = 16;
  struct Point {
    double width_m = 0.0;
    double angle_rad = 0.0;
  };
  /// `count` of them, widths rising, angles monotone.
  std::array<Point, kMostPoints> points{};
  std::size_t count = 0;

  double width(double angle) const noexcept {
    const std::size_t i = piece([&](const Point& p) { return rises() == (angle >= p.angle_rad); });
    return points[i].width_m + slope_of(i) * (angle - points[i].angle_rad);
  }
  double angle(double width) const noexcept {
    const std::size_t i = piece([&](const Point& p) { return width >= p.width_m; });
    return points[i].angle_rad + (width - points[i].width_m) / slope_of(i);
  }
  /// dw/dtheta, m/rad.
  double slope(double angle) const noexcept {
    return slope_of(piece([&](const Point& p) { return rises() == (angle >= p.angle_rad); }));
  }
  double closed_m() const noexcept { return points[0].width_m; }
  double open_m() const noexcept { return points[count - 1].width_m; }
  double steepest() const noexcept {
    double most = 0.0;
    for (std::size_t i = 0; i + 1 < count; ++i) most = std::max(most, std::abs(slope_of(i)));
    return most;
  }
  double flattest() const noexcept {
    double least = steepest();
    for (std::size_t i = 0; i + 1 < count; ++i) least = std::min(least, std::abs(slope_of(i)));
    return least;
  }
  /// The width rises with the angle.
  bool rises() const noexcept { return points[1].angle_rad > points[0].angle_rad; }

 private:
  /// The last piece whose first point is `before` the value.
  template <typename Before>
  std::size_t piece(Before before) const noexcept {
    std::size_t i = 0;
    while (i + 2 < count && before(points[i + 1])) ++i;
    return i;
  }
  double slope_of(std::size_t i) const noexcept {
    return (points[i + 1].width_m - points[i].width_m) /
           (points[i + 1].angle_rad - points[i].angle_rad);
  }
};

}  // namespace limber
