// The state that all drives of the arm share, with the first fault since the last acknowledgement.
// A fault is latched in FALLBACK, DAMP and FAULT, and in no other state.
#pragma once

#include "drivers/drive/drive_table.h"

namespace limber {

/// All members are allowed in the cycle.
class DriveStateMachine {
 public:
  /// Follows the table; true if the state changed. `joint`: index of the joint at fault, -1: none.
  bool apply(DriveEvent event, int joint = -1) noexcept;

  DriveState state() const noexcept { return state_; }
  /// FALLBACK or DAMP: the drives act without the controller.
  bool holding() const noexcept {
    return state_ == DriveState::kFallback || state_ == DriveState::kDamp;
  }
  /// Some drive may be enabled.
  bool powered() const noexcept {
    return state_ == DriveState::kEnabling || state_ == DriveState::kOn || holding();
  }
  /// FAULT_* of joint_state_t.
  std::int8_t fault() const noexcept { return fault_; }
  std::int8_t fault_joint() const noexcept { return fault_joint_; }
  /// In FALLBACK or DAMP: the fault was acknowledged and none came since.
  bool acknowledged() const noexcept { return acknowledged_; }

 private:
  DriveState state_ = DriveState::kConfiguring;
  std::int8_t fault_ = joint_state_t::FAULT_NONE;
  std::int8_t fault_joint_ = -1;
  bool acknowledged_ = false;
};

}  // namespace limber
