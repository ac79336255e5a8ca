#include "drivers/drive/drive_table.h"

namespace limber {
namespace {

using State = DriveState;
using Event = DriveEvent;
using Fault = joint_state_t;

constexpr std::int8_t kNoFault = Fault::FAULT_NONE;

constexpr DriveTransition kTransitions[] = {
    // Start-up dialogue: nothing is enabled.
    {State::kConfiguring, Event::kConfigured, State::kOff, kNoFault},
    {State::kConfiguring, Event::kConfigurationWrong, State::kFault, Fault::FAULT_CONFIGURATION},
    {State::kConfiguring, Event::kForeignCommand, State::kFault, Fault::FAULT_FOREIGN_COMMAND},
    {State::kConfiguring, Event::kBusLost, State::kFault, Fault::FAULT_BUS},

    // Polled.
    {State::kOff, Event::kRequestOn, State::kEnabling, kNoFault},
    {State::kOff, Event::kReplyLost, State::kFault, Fault::FAULT_REPLY_LOST},
    {State::kOff, Event::kAllSilent, State::kFault, Fault::FAULT_REPLY_LOST},
    {State::kOff, Event::kReplyInvalid, State::kFault, Fault::FAULT_REPLY_INVALID},
    {State::kOff, Event::kForeignCommand, State::kFault, Fault::FAULT_FOREIGN_COMMAND},
    {State::kOff, Event::kBusLost, State::kFault, Fault::FAULT_BUS},
    {State::kOff, Event::kEmergencyStop, State::kFault, Fault::FAULT_EMERGENCY_STOP},

    // Not all are enabled yet: whatever goes wrong ends it.
    {State::kEnabling, Event::kEnabled, State::kOn, kNoFault},
    {State::kEnabling, Event::kRequestOff, State::kOff, kNoFault},
    {State::kEnabling, Event::kRequestHold, State::kOff, Fault::FAULT_REQUESTED},
    {State::kEnabling, Event::kShutDown, State::kOff, Fault::FAULT_REQUESTED},
    {State::kEnabling, Event::kEnableTimedOut, State::kFault, Fault::FAULT_DRIVE_ERROR},
    {State::kEnabling, Event::kControllerLost, State::kFault, Fault::FAULT_CONTROLLER_LOST},
    {State::kEnabling, Event::kCommandRefused, State::kFault, Fault::FAULT_COMMAND_REFUSED},
    {State::kEnabling, Event::kOverrun, State::kFault, Fault::FAULT_OVERRUN},
    {State::kEnabling, Event::kReplyLost, State::kFault, Fault::FAULT_REPLY_LOST},
    {State::kEnabling, Event::kAllSilent, State::kFault, Fault::FAULT_REPLY_LOST},
    {State::kEnabling, Event::kReplyInvalid, State::kFault, Fault::FAULT_REPLY_INVALID},
    {State::kEnabling, Event::kForeignCommand, State::kFault, Fault::FAULT_FOREIGN_COMMAND},
    {State::kEnabling, Event::kBusLost, State::kFault, Fault::FAULT_BUS},
    {State::kEnabling, Event::kDriveError, State::kFault, Fault::FAULT_DRIVE_ERROR},
    {State::kEnabling, Event::kFeedbackWrong, State::kFault, Fault::FAULT_FEEDBACK},
    {State::kEnabling, Event::kTooHot, State::kFault, Fault::FAULT_TEMPERATURE},
    {State::kEnabling, Event::kPositionTrip, State::kFault, Fault::FAULT_POSITION},
    {State::kEnabling, Event::kVelocityTrip, State::kFault, Fault::FAULT_VELOCITY},
    {State::kEnabling, Event::kEmergencyStop, State::kFault, Fault::FAULT_EMERGENCY_STOP},

    // The controller's torque.
    {State::kOn, Event::kRequestOff, State::kOff, kNoFault},
    {State::kOn, Event::kRequestHold, State::kFallback, Fault::FAULT_REQUESTED},
    {State::kOn, Event::kShutDown, State::kDamp, Fault::FAULT_REQUESTED},
    {State::kOn, Event::kControllerLost, State::kFallback, Fault::FAULT_CONTROLLER_LOST},
    {State::kOn, Event::kCommandRefused, State::kFallback, Fault::FAULT_COMMAND_REFUSED},
    {State::kOn, Event::kOverrun, State::kFallback, Fault::FAULT_OVERRUN},
    {State::kOn, Event::kReplyLost, State::kFallback, Fault::FAULT_REPLY_LOST},
    {State::kOn, Event::kAllSilent, State::kFault, Fault::FAULT_REPLY_LOST},
    {State::kOn, Event::kReplyInvalid, State::kFallback, Fault::FAULT_REPLY_INVALID},
    {State::kOn, Event::kForeignCommand, State::kFallback, Fault::FAULT_FOREIGN_COMMAND},
    {State::kOn, Event::kBusLost, State::kFallback, Fault::FAULT_BUS},
    {State::kOn, Event::kDriveError, State::kFallback, Fault::FAULT_DRIVE_ERROR},
    {State::kOn, Event::kFeedbackWrong, State::kFallback, Fault::FAULT_FEEDBACK},
    {State::kOn, Event::kTooHot, State::kFallback, Fault::FAULT_TEMPERATURE},
    {State::kOn, Event::kPositionTrip, State::kFallback, Fault::FAULT_POSITION},
    {State::kOn, Event::kVelocityTrip, State::kDamp, Fault::FAULT_VELOCITY},
    {State::kOn, Event::kEmergencyStop, State::kFallback, Fault::FAULT_EMERGENCY_STOP},

    // The drives hold the arm.
    {State::kFallback, Event::kTakenOver, State::kOn, kNoFault},
    {State::kFallback, Event::kRequestOff, State::kConfiguring, kNoFault},
    {State::kFallback, Event::kRequestHold, State::kFallback, Fault::FAULT_REQUESTED},
    {State::kFallback, Event::kAcknowledge, State::kFallback, kNoFault},
    {State::kFallback, Event::kShutDown, State::kDamp, Fault::FAULT_REQUESTED},
    {State::kFallback, Event::kControllerLost, State::kFallback, Fault::FAULT_CONTROLLER_LOST},
    {State::kFallback, Event::kOverrun, State::kFallback, Fault::FAULT_OVERRUN},
    {State::kFallback, Event::kReplyLost, State::kFallback, Fault::FAULT_REPLY_LOST},
    {State::kFallback, Event::kAllSilent, State::kFault, Fault::FAULT_REPLY_LOST},
    {State::kFallback, Event::kReplyInvalid, State::kFallback, Fault::FAULT_REPLY_INVALID},
    {State::kFallback, Event::kForeignCommand, State::kFallback, Fault::FAULT_FOREIGN_COMMAND},
    {State::kFallback, Event::kBusLost, State::kFallback, Fault::FAULT_BUS},
    {State::kFallback, Event::kDriveError, State::kFallback, Fault::FAULT_DRIVE_ERROR},
    {State::kFallback, Event::kFeedbackWrong, State::kFallback, Fault::FAULT_FEEDBACK},
    {State::kFallback, Event::kTooHot, State::kFallback, Fault::FAULT_TEMPERATURE},
    {State::kFallback, Event::kPositionTrip, State::kFallback, Fault::FAULT_POSITION},
    {State::kFallback, Event::kVelocityTrip, State::kDamp, Fault::FAULT_VELOCITY},
    {State::kFallback, Event::kEmergencyStop, State::kFallback, Fault::FAULT_EMERGENCY_STOP},
    {State::kFallback, Event::kEmergencyOff, State::kFault, Fault::FAULT_EMERGENCY_STOP},

    // The drives brake: from here to FAULT, or back on request.
    {State::kDamp, Event::kTakenOver, State::kOn, kNoFault},
    {State::kDamp, Event::kRequestOff, State::kConfiguring, kNoFault},
    {State::kDamp, Event::kRequestHold, State::kDamp, Fault::FAULT_REQUESTED},
    {State::kDamp, Event::kAcknowledge, State::kDamp, kNoFault},
    {State::kDamp, Event::kShutDown, State::kDamp, Fault::FAULT_REQUESTED},
    {State::kDamp, Event::kControllerLost, State::kDamp, Fault::FAULT_CONTROLLER_LOST},
    {State::kDamp, Event::kOverrun, State::kDamp, Fault::FAULT_OVERRUN},
    {State::kDamp, Event::kReplyLost, State::kDamp, Fault::FAULT_REPLY_LOST},
    {State::kDamp, Event::kAllSilent, State::kFault, Fault::FAULT_REPLY_LOST},
    {State::kDamp, Event::kReplyInvalid, State::kDamp, Fault::FAULT_REPLY_INVALID},
    {State::kDamp, Event::kForeignCommand, State::kDamp, Fault::FAULT_FOREIGN_COMMAND},
    {State::kDamp, Event::kBusLost, State::kDamp, Fault::FAULT_BUS},
    {State::kDamp, Event::kDriveError, State::kDamp, Fault::FAULT_DRIVE_ERROR},
    {State::kDamp, Event::kFeedbackWrong, State::kDamp, Fault::FAULT_FEEDBACK},
    {State::kDamp, Event::kTooHot, State::kDamp, Fault::FAULT_TEMPERATURE},
    {State::kDamp, Event::kPositionTrip, State::kDamp, Fault::FAULT_POSITION},
    {State::kDamp, Event::kVelocityTrip, State::kDamp, Fault::FAULT_VELOCITY},
    {State::kDamp, Event::kEmergencyStop, State::kDamp, Fault::FAULT_EMERGENCY_STOP},
    {State::kDamp, Event::kEmergencyOff, State::kFault, Fault::FAULT_EMERGENCY_STOP},

    // Latched.
    {State::kFault, Event::kAcknowledge, State::kConfiguring, kNoFault},
};

}  // namespace

std::span<const DriveTransition> drive_transitions() noexcept { return kTransitions; }

const DriveTransition* find_drive_transition(DriveState state, DriveEvent event) noexcept {
  for (const DriveTransition& transition : kTransitions) {
    if (transition.from == state && transition.event == event) return &transition;
  }
  return nullptr;
}

}  // namespace limber
