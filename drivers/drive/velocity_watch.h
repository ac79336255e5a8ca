// Does the reported velocity fit the reported positions?
//
//   e' = v - q' - e / tau        tau = 0.5 s: what the velocity promised and the position did not
//   do
//
// Contradiction: abs(e) > min(v_max tau / 4, near + 70 ms v_top) and two counts of position, where
// v_top is the greatest speed reported, of which half a second later a third is left, and near is
// 0.08 rad. A velocity that is wrong by dv, or an angle that drifts by dv, makes
// e = dv tau (1 - exp(-t / tau)).
//
// What is no contradiction:
//   filter of the velocity, lag L            e = L v, no more than 20 ms v_top
//   a pause unseen by one side               e = 50 ms v_top
//   acceleration, trapezoids of 50 ms        e <= 2.2 v_max 50 ms / 4 = 0.22 of v_max tau / 4,
//   within 50 ms 12 bits over +-45 rad/s, half a count    e <= 0.011 rad/s tau = 0.0055 rad a drive
//   that reports 0 below 0.1 rad/s   e = 0.05 rad
// Position counts do not add up: their differences do.
#pragma once

#include <cmath>

namespace limber {

/// Allowed in the cycle. Of a joint or of a motor, rad and rad/s or m and m/s.
class VelocityWatch {
 public:
  VelocityWatch(double velocity_limit, double position_count) noexcept
      : far_(0.25 * velocity_limit * kMemory_s), counts_(2.0 * position_count) {}

  /// Forgets everything: the next state begins afresh.
  void reset() noexcept {
    known_ = false;
    e_ = 0.0;
    top_ = 0.0;
  }
  /// A state, once each; `time_s`: of its cycle.
  void add(double position, double velocity, double time_s) noexcept {
    const double dt = time_s - time_s_;
    if (known_ && dt > 0.0) {
      const double kept = std::fmax(1.0 - dt / kMemory_s, 0.0);
      e_ *= kept;
      top_ *= kept;
      e_ += 0.5 * (velocity + velocity_) * dt - (position - position_);
    }
    top_ = std::fmax(top_, std::abs(velocity));
    known_ = true;
    position_ = position;
    velocity_ = velocity;
    time_s_ = time_s;
  }
  bool contradicts() const noexcept { return !(std::abs(e_) <= most()); }

 private:
  static constexpr double kMemory_s = 0.5;
  static constexpr double kNear = 0.08;
  static constexpr double kLag_s = 0.07;

  double most() const noexcept { return std::fmin(far_, kNear + kLag_s * top_) + counts_; }

  double far_;
  double counts_;
  bool known_ = false;
  double e_ = 0.0;
  double top_ = 0.0;
  double position_ = 0.0;
  double velocity_ = 0.0;
  double time_s_ = 0.0;
};

}  // namespace limber
