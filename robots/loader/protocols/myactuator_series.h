// Models of MyActuator drives by the n of "RMD-Xn-...", with the torque that a command's field
// spans from firmware V4.4 on: the motor's maximum.
// Source: github.com/almond-bot/axol, motor/myactuator.py, commit 3d3c09cb of 2026-08.
#pragma once

#include <algorithm>
#include <array>

namespace limber {

struct MyactuatorSeries {
  int number;
  double most_Nm;
};
inline constexpr std::array kMyactuatorSeries = {MyactuatorSeries{6, 60.0},
                                                 MyactuatorSeries{8, 129.0}};

/// By either number; 0 if it is not listed.
inline int series_with(double most_Nm) noexcept {
  const auto* found = std::ranges::find(kMyactuatorSeries, most_Nm, &MyactuatorSeries::most_Nm);
  return found == kMyactuatorSeries.end() ? 0 : found->number;
}
inline bool is_listed(int series) noexcept {
  return std::ranges::find(kMyactuatorSeries, series, &MyactuatorSeries::number) !=
         kMyactuatorSeries.end();
}

}  // namespace limber
