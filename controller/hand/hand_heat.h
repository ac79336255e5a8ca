// What a motor may make before its winding is too warm: I2t.
//
//   x' = ((tau / tau_rated)^2 - x) / T       heat over that of the rated torque for ever
//   |tau| <= tau_rated sqrt(1 + (1 - x) / (1 - kWarm) ((tau_peak / tau_rated)^2 - 1))   for x >
//   kWarm
//
// so that the bound falls from the peak at x = kWarm to the rated torque at x = 1, which x never
// passes. From cold, at constant tau, x = kWarm is reached after -T ln(1 - kWarm
// (tau_rated/tau)^2). The winding as one body with the time constant T; copper losses alone.
#pragma once

#include <algorithm>
#include <cmath>

namespace limber::controller {

/// A value; every member is allowed in the cycle.
class HandHeat {
 public:
  static constexpr double kWarm = 0.8;

  /// N m at the motor behind its gear, rated <= peak; s.
  HandHeat(double rated_Nm, double peak_Nm, double time_constant_s) noexcept
      : rated_Nm_(rated_Nm), peak_Nm_(peak_Nm), time_constant_s_(time_constant_s) {}

  /// `torque` was made for dt seconds.
  void add(double torque, double dt_s) noexcept {
    const double share = torque / rated_Nm_;
    heat_ += (share * share - heat_) * -std::expm1(-dt_s / time_constant_s_);
  }
  double heat() const noexcept { return heat_; }
  bool warm() const noexcept { return heat_ > kWarm; }
  /// N m.
  double bound() const noexcept {
    if (!warm()) return peak_Nm_;
    const double most = peak_Nm_ / rated_Nm_;
    const double left = std::max(1.0 - heat_, 0.0) / (1.0 - kWarm);
    return rated_Nm_ * std::sqrt(1.0 + left * (most * most - 1.0));
  }

 private:
  double rated_Nm_;
  double peak_Nm_;
  double time_constant_s_;
  double heat_ = 0.0;
};

}  // namespace limber::controller
