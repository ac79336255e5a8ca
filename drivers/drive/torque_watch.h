// Does the torque that a drive reports fit what it was commanded?
//
//   far:       tau < low - tau_max / 2   or  tau > high + tau_max / 2       for 0.1 s
//   opposite:  tau < low - tau_max / 10  while tau_c > 0,  or
//              tau > high + tau_max / 10 while tau_c < 0                    for 10 ms
//   low = min(tau_c, low'),  low' falls to zero with 30 ms; high likewise
//
// both without a break. [low, high] holds zero and what was commanded a moment ago: the reply's
// delay (a cycle) and the lag of a current loop (20 ms for the slowest simulated actuator) stay
// within. Less than commanded is no contradiction: drives reduce their current when they are warm,
// fast, or at a limit. A drive that turns a torque below tau_max / 10 around is not found here.
// Of drives whose torque is their estimate from the current; a sensor behind the motor measures
// what acts on the link, and that may be anything.
#pragma once

#include <algorithm>
#include <cmath>

namespace limber {

/// Allowed in the cycle. N m, or N.
class TorqueWatch {
 public:
  explicit TorqueWatch(double torque_limit) noexcept : torque_limit_(torque_limit) {}

  void reset() noexcept { low_ = high_ = far_s_ = opposite_s_ = 0.0; }
  /// `dt_s`: since the last state.
  void add(double reported, double commanded, double dt_s) noexcept {
    const double kept = std::fmax(1.0 - dt_s / kLag_s, 0.0);
    low_ = std::min(commanded, kept * low_);
    high_ = std::max(commanded, kept * high_);
    const double beyond = std::max(low_ - reported, reported - high_);
    const bool same_way = reported * commanded >= 0.0;
    far_s_ = beyond <= 0.5 * torque_limit_ ? 0.0 : far_s_ + dt_s;
    opposite_s_ = same_way || beyond <= 0.1 * torque_limit_ ? 0.0 : opposite_s_ + dt_s;
  }
  bool contradicts() const noexcept { return far_s_ > kFarFor_s || opposite_s_ > kOppositeFor_s; }

 private:
  static constexpr double kLag_s = 0.03;
  static constexpr double kFarFor_s = 0.1;
  static constexpr double kOppositeFor_s = 0.01;
  double torque_limit_;
  double low_ = 0.0;
  double high_ = 0.0;
  double far_s_ = 0.0;
  double opposite_s_ = 0.0;
};

}  // namespace limber
