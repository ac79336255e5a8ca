// Does the reported velocity fit the reported positions?
//
//   e' = v - q' - e / tau        tau = 0.5 s: what the velocity promised and the position did not
//   do
//
// Contradiction: abs(e) > v_max tau / 4 and two counts of position. A velocity that is wrong by dv
// makes e = dv tau (1 - exp(-t / tau)): by v_max after 0.144 s, by v_max / 2 after 0.35 s, by
// v_max / 4 or less never.
//
// What is no contradiction, in units of v_max tau / 4 = v_max 125 ms:
//   filter of the velocity, lag L       e <= 2.2 v_max L (from -1.1 to 1.1 v_max)   L = 20 ms: 0.35
//   a pause of 50 ms, unseen by one side     e <= 1.1 v_max 50 ms                             0.44
//   acceleration, trapezoids of 50 ms    e <= 2.2 v_max 50 ms / 4                             0.22
//   12 bits over +-45 rad/s, half a count   e <= 0.011 rad/s tau; v_max = 1 rad/s             0.04
// Position counts do not add up: their differences do.
#pragma once

#include <cmath>

namespace limber {

/// Allowed in the cycle. Of a joint or of a motor, rad and rad/s or m and m/s.
class VelocityWatch {
 public:
  VelocityWatch(double velocity_limit, double position_count) noexcept
      : most_(0.25 * velocity_limit * kMemory_s + 2.0 * position_count) {}

  /// Forgets everything: the next state begins afresh.
  void reset() noexcept {
    known_ = false;
    e_ = 0.0;
  }
  /// A state, once each; `time_s`: of its cycle.
  void add(double position, double velocity, double time_s) noexcept {
    const double dt = time_s - time_s_;
    if (known_ && dt > 0.0) {
      e_ *= std::fmax(1.0 - dt / kMemory_s, 0.0);
      e_ += 0.5 * (velocity + velocity_) * dt - (position - position_);
    }
    known_ = true;
    position_ = position;
    velocity_ = velocity;
    time_s_ = time_s;
  }
  bool contradicts() const noexcept { return !(std::abs(e_) <= most_); }

 private:
  static constexpr double kMemory_s = 0.5;
  double most_;
  bool known_ = false;
  double e_ = 0.0;
  double position_ = 0.0;
  double velocity_ = 0.0;
  double time_s_ = 0.0;
};

}  // namespace limber
