// Does the torque that a drive reports fit what it was commanded?
//
//   contradiction: tau < min(tau_c, 0) - m  or  tau > max(tau_c, 0) + m   for 0.1 s without a break
//   m = tau_max / 2
//
// Less than commanded is none: drives reduce their current when they are warm, fast, or at a limit.
// The delay of the reply (a cycle) and the lag of a current loop (milliseconds; 20 ms for the
// slowest simulated actuator) end long before 0.1 s. Of drives whose torque is their estimate from
// the current; a sensor behind the motor measures what acts on the link, and that may be anything.
#pragma once

#include <algorithm>

namespace limber {

/// Allowed in the cycle. N m, or N.
class TorqueWatch {
 public:
  explicit TorqueWatch(double torque_limit) noexcept : margin_(0.5 * torque_limit) {}

  void reset() noexcept { wrong_s_ = 0.0; }
  /// `dt_s`: since the last state.
  void add(double reported, double commanded, double dt_s) noexcept {
    const bool fits = reported >= std::min(commanded, 0.0) - margin_ &&
                      reported <= std::max(commanded, 0.0) + margin_;
    wrong_s_ = fits ? 0.0 : wrong_s_ + dt_s;
  }
  bool contradicts() const noexcept { return wrong_s_ > kLong_s; }

 private:
  static constexpr double kLong_s = 0.1;
  double margin_;
  double wrong_s_ = 0.0;
};

}  // namespace limber
