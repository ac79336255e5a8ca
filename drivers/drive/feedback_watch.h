// What one motor reports, held against itself: velocities against positions, torque against the
// command.
#pragma once

#include <cstdint>

#include "drivers/drive/joint_link.h"
#include "drivers/drive/torque_watch.h"
#include "drivers/drive/velocity_watch.h"

namespace limber {

/// What contradicts; the numbers are those of a fault's detail.
enum class Contradiction : std::uint8_t { kNone, kVelocity, kLinkVelocity, kTorque };

/// Allowed in the cycle.
class FeedbackWatch {
 public:
  explicit FeedbackWatch(const JointLink& link) noexcept;

  void reset() noexcept;
  /// End of a cycle in which the motor has answered; `time_s`: of the cycle.
  void add(const JointLink& link, double time_s) noexcept;
  Contradiction found() const noexcept;

 private:
  VelocityWatch velocity_;
  VelocityWatch link_velocity_;
  TorqueWatch torque_;
  bool has_link_encoder_;
  bool has_torque_sensor_;
  double time_s_ = 0.0;
  bool known_ = false;
};

}  // namespace limber
