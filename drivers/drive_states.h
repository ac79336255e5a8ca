// What the drives of an arm may do, and what makes that change: one table.
//
//   CONFIGURING -> OFF -> ENABLING -> ON -> OFF        as the controller asks
//                                     ON -> HOLD -> DAMP -> FAULT     by itself: escalate only
//   HOLD, DAMP -> ON               acknowledged, and without a torque jump
//   HOLD, DAMP -> CONFIGURING      switched off: whatever happened, start again from the beginning
//   FAULT -> CONFIGURING           acknowledged
//
// A fault is latched in HOLD, DAMP and FAULT, and in no other state: nothing leaves them by itself.
#pragma once

#include <cstdint>
#include <limber/joint_state_t.hpp>

namespace limber {

/// DRIVE_* of joint_state_t.
enum class DriveState : std::int8_t {
  kConfiguring = joint_state_t::DRIVE_CONFIGURING,  ///< start-up dialogue; nothing is enabled
  kOff = joint_state_t::DRIVE_OFF,                  ///< polled, never commanded
  kEnabling = joint_state_t::DRIVE_ENABLING,  ///< zero torque, one drive after the other comes up
  kOn = joint_state_t::DRIVE_ON,              ///< the controller's torque
  kHold = joint_state_t::DRIVE_HOLD,          ///< gravity and damping, then the drives hold
  kDamp = joint_state_t::DRIVE_DAMP,          ///< the drives brake, nothing else
  kFault = joint_state_t::DRIVE_FAULT,        ///< disabled, latched
};
inline constexpr int kDriveStates = 7;

enum class DriveEvent : std::int8_t {
  // progress
  kConfigured,  ///< every drive has said what robot.yaml says
  kEnabled,     ///< every drive reports enabled
  kTakenOver,   ///< acknowledged, healthy, and a torque close to the one present was accepted
  // the controller's requests
  kRequestOn,
  kRequestOff,
  kRequestHold,
  kAcknowledge,
  // the process ends
  kShutDown,
  // what went wrong
  kConfigurationWrong,
  kEnableTimedOut,
  kControllerLost,
  kCommandRefused,
  kOverrun,
  kHoldAsked,  ///< by the operator or the process
  kReplyLost,  ///< a joint is silent or its encoder not plausible
  kAllSilent,  ///< no drive speaks, or none is enabled any more
  kBusLost,
  kDriveError,
  kPositionTrip,
  kVelocityTrip,
};
inline constexpr int kDriveEvents = 20;

/// What the table says to an event in a state: where to go, or that the event means nothing there.
/// Going to the present state is not nothing: the event's fault is latched, an acknowledgement
/// ends.
struct DriveTransition {
  bool ignored = true;
  DriveState next = DriveState::kFault;
};
DriveTransition drive_transition(DriveState state, DriveEvent event) noexcept;

/// FAULT_* an event stands for; FAULT_NONE for progress and requests that are no fault.
std::int8_t fault_of(DriveEvent event) noexcept;

/// The table with its present state and the first fault since the last acknowledgement.
class DriveStateMachine {
 public:
  /// Returns true if the state changed. Allowed inside the cycle.
  bool apply(DriveEvent event, int joint = -1) noexcept;

  DriveState state() const noexcept { return state_; }
  std::int8_t fault() const noexcept { return fault_; }
  std::int8_t fault_joint() const noexcept { return fault_joint_; }
  /// In HOLD or DAMP: the fault was acknowledged and none came since.
  bool acknowledged() const noexcept { return acknowledged_; }
  /// Some drive may be enabled.
  bool powered() const noexcept;

 private:
  DriveState state_ = DriveState::kConfiguring;
  std::int8_t fault_ = joint_state_t::FAULT_NONE;
  std::int8_t fault_joint_ = -1;
  bool acknowledged_ = false;
};

}  // namespace limber
