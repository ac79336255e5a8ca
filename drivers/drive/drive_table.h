// What the drives of an arm may do, and what makes that change: one table, nothing else decides.
//
//   CONFIGURING -> OFF -> ENABLING -> ON -> OFF        on request of the controller
//                             ON -> FALLBACK -> DAMP -> FAULT     by itself: escalates only
//   FALLBACK, DAMP -> ON               acknowledged, and without a torque jump
//   FALLBACK, DAMP -> CONFIGURING      switched off: the start-up is repeated from its beginning
//   FAULT -> CONFIGURING               acknowledged
#pragma once

#include <cstdint>
#include <limber/joint_state_t.hpp>
#include <span>

namespace limber {

/// Numbers of joint_state_t, DRIVE_*. FALLBACK is DRIVE_HOLD there: the drives hold the arm without
/// the controller. HOLD is a mode of the controller, in which the drives are ON.
enum class DriveState : std::int8_t {
  kConfiguring = joint_state_t::DRIVE_CONFIGURING,  ///< start-up dialogue; nothing is enabled
  kOff = joint_state_t::DRIVE_OFF,                  ///< polled, never commanded
  kEnabling = joint_state_t::DRIVE_ENABLING,  ///< zero torque, one drive after the other comes up
  kOn = joint_state_t::DRIVE_ON,              ///< the controller's torque
  kFallback = joint_state_t::DRIVE_HOLD,      ///< gravity and damping, then the drives hold
  kDamp = joint_state_t::DRIVE_DAMP,          ///< the drives brake, nothing else
  kFault = joint_state_t::DRIVE_FAULT,        ///< disabled, latched
};
inline constexpr int kDriveStates = 7;

enum class DriveEvent : std::int8_t {
  // progress
  kConfigured,  ///< every drive's settings agree with robot.yaml
  kEnabled,     ///< every drive reports enabled
  kTakenOver,   ///< acknowledged, healthy, and a torque close to the one present was accepted
  // requests of the controller
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
  kCommandRefused,  ///< three times within 100 ms
  kOverrun,         ///< too many cycles took longer than their period
  kReplyLost,       ///< a joint is silent or its encoder not plausible
  kAllSilent,       ///< no drive replies, or none is enabled any more
  kReplyInvalid,    ///< a joint's replies are often doubled or senseless: two motors, or a forger
  kForeignCommand,  ///< somebody else commands a drive of this arm
  kBusLost,
  kDriveError,
  kFeedbackWrong,  ///< reported velocity or torque contradicts position or command
  kTooHot,         ///< a drive is hotter than its limit, and can still hold
  kPositionTrip,
  kVelocityTrip,
  kEmergencyStop,  ///< pressed, or silent
  kEmergencyOff,   ///< the drives have held long enough
};
inline constexpr int kDriveEvents = 25;

struct DriveTransition {
  DriveState from;
  DriveEvent event;
  /// Going to the state `from` is not nothing: the fault is latched, an acknowledgement ends.
  DriveState to;
  std::int8_t fault;  ///< FAULT_* of joint_state_t; FAULT_NONE for progress and requests
};

/// Every transition. An event that is not listed for a state is ignored in it.
std::span<const DriveTransition> drive_transitions() noexcept;

/// The row for an event in a state, or nullptr. Allowed in the cycle.
const DriveTransition* find_drive_transition(DriveState state, DriveEvent event) noexcept;

}  // namespace limber
