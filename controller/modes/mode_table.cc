#include "controller/modes/mode_table.h"

namespace limber::controller {
namespace {

using Status = controller_status_t;

constexpr std::int8_t kKeep = Status::REASON_NONE;

constexpr Transition kTransitions[] = {
    {Mode::kBoot, Event::kFirstState, Mode::kInit, kKeep},
    {Mode::kInit, Event::kSteadyStates, Mode::kIdle, kKeep},

    {Mode::kIdle, Event::kRequestIdle, Mode::kIdle, kKeep},
    {Mode::kIdle, Event::kRequestHold, Mode::kHold, kKeep},
    {Mode::kHold, Event::kRequestHold, Mode::kHold, kKeep},
    {Mode::kHold, Event::kRequestIdle, Mode::kIdle, kKeep},
    {Mode::kHold, Event::kRequestActive, Mode::kActive, kKeep},
    {Mode::kActive, Event::kRequestActive, Mode::kActive, kKeep},
    {Mode::kActive, Event::kRequestHold, Mode::kSoftStop, kKeep},
    {Mode::kSoftStop, Event::kRequestHold, Mode::kSoftStop, kKeep},
    {Mode::kSoftStop, Event::kAtRest, Mode::kHold, kKeep},
    {Mode::kFault, Event::kRequestAcknowledge, Mode::kIdle, kKeep},
    {Mode::kEstop, Event::kRequestAcknowledge, Mode::kIdle, kKeep},

    // A stop is obeyed in every mode; where nothing moves it changes nothing.
    {Mode::kBoot, Event::kRequestStop, Mode::kBoot, kKeep},
    {Mode::kInit, Event::kRequestStop, Mode::kInit, kKeep},
    {Mode::kIdle, Event::kRequestStop, Mode::kIdle, kKeep},
    {Mode::kHold, Event::kRequestStop, Mode::kHold, kKeep},
    {Mode::kActive, Event::kRequestStop, Mode::kSoftStop, Status::REASON_STOP_REQUESTED},
    {Mode::kSoftStop, Event::kRequestStop, Mode::kSoftStop, Status::REASON_STOP_REQUESTED},
    {Mode::kFault, Event::kRequestStop, Mode::kFault, kKeep},
    {Mode::kEstop, Event::kRequestStop, Mode::kEstop, kKeep},

    {Mode::kActive, Event::kClientSilent, Mode::kSoftStop, Status::REASON_CLIENT_SILENT},

    // Without power: check again from the beginning.
    {Mode::kInit, Event::kStateLost, Mode::kInit, kKeep},
    {Mode::kInit, Event::kStateInvalid, Mode::kInit, kKeep},
    {Mode::kInit, Event::kNewSession, Mode::kInit, kKeep},
    {Mode::kIdle, Event::kStateLost, Mode::kInit, Status::REASON_STATE_LOST},
    {Mode::kIdle, Event::kStateInvalid, Mode::kInit, Status::REASON_STATE_INVALID},
    {Mode::kIdle, Event::kNewSession, Mode::kInit, Status::REASON_SESSION_CHANGED},

    // With power: latch.
    {Mode::kHold, Event::kStateLost, Mode::kFault, Status::REASON_STATE_LOST},
    {Mode::kHold, Event::kStateInvalid, Mode::kFault, Status::REASON_STATE_INVALID},
    {Mode::kHold, Event::kDriverFault, Mode::kFault, Status::REASON_DRIVER_FAULT},
    {Mode::kHold, Event::kNewSession, Mode::kFault, Status::REASON_SESSION_CHANGED},
    {Mode::kHold, Event::kTorqueInvalid, Mode::kFault, Status::REASON_TORQUE_INVALID},
    {Mode::kHold, Event::kDriveNotOn, Mode::kFault, Status::REASON_DRIVE_NOT_ON},
    {Mode::kHold, Event::kStrayed, Mode::kFault, Status::REASON_STRAYED},
    {Mode::kHold, Event::kOverdriven, Mode::kFault, Status::REASON_OVERDRIVEN},
    {Mode::kHold, Event::kEncoderStopped, Mode::kFault, Status::REASON_ENCODER_STOPPED},
    {Mode::kHold, Event::kEnergy, Mode::kFault, Status::REASON_ENERGY},
    {Mode::kActive, Event::kStateLost, Mode::kFault, Status::REASON_STATE_LOST},
    {Mode::kActive, Event::kStateInvalid, Mode::kFault, Status::REASON_STATE_INVALID},
    {Mode::kActive, Event::kDriverFault, Mode::kFault, Status::REASON_DRIVER_FAULT},
    {Mode::kActive, Event::kNewSession, Mode::kFault, Status::REASON_SESSION_CHANGED},
    {Mode::kActive, Event::kTorqueInvalid, Mode::kFault, Status::REASON_TORQUE_INVALID},
    {Mode::kActive, Event::kStrayed, Mode::kFault, Status::REASON_STRAYED},
    {Mode::kActive, Event::kOverdriven, Mode::kFault, Status::REASON_OVERDRIVEN},
    {Mode::kActive, Event::kEncoderStopped, Mode::kFault, Status::REASON_ENCODER_STOPPED},
    {Mode::kActive, Event::kEnergy, Mode::kFault, Status::REASON_ENERGY},
    {Mode::kSoftStop, Event::kStateLost, Mode::kFault, Status::REASON_STATE_LOST},
    {Mode::kSoftStop, Event::kStateInvalid, Mode::kFault, Status::REASON_STATE_INVALID},
    {Mode::kSoftStop, Event::kDriverFault, Mode::kFault, Status::REASON_DRIVER_FAULT},
    {Mode::kSoftStop, Event::kNewSession, Mode::kFault, Status::REASON_SESSION_CHANGED},
    {Mode::kSoftStop, Event::kTorqueInvalid, Mode::kFault, Status::REASON_TORQUE_INVALID},
    {Mode::kSoftStop, Event::kStrayed, Mode::kFault, Status::REASON_STRAYED},
    {Mode::kSoftStop, Event::kOverdriven, Mode::kFault, Status::REASON_OVERDRIVEN},
    {Mode::kSoftStop, Event::kEncoderStopped, Mode::kFault, Status::REASON_ENCODER_STOPPED},
    {Mode::kSoftStop, Event::kEnergy, Mode::kFault, Status::REASON_ENERGY},

    {Mode::kBoot, Event::kEstopPressed, Mode::kEstop, kKeep},
    {Mode::kInit, Event::kEstopPressed, Mode::kEstop, kKeep},
    {Mode::kIdle, Event::kEstopPressed, Mode::kEstop, kKeep},
    {Mode::kHold, Event::kEstopPressed, Mode::kEstop, kKeep},
    {Mode::kActive, Event::kEstopPressed, Mode::kEstop, kKeep},
    {Mode::kSoftStop, Event::kEstopPressed, Mode::kEstop, kKeep},
    {Mode::kFault, Event::kEstopPressed, Mode::kEstop, kKeep},
};

}  // namespace

std::span<const Transition> transitions() noexcept { return kTransitions; }

const Transition* find_transition(Mode mode, Event event) noexcept {
  for (const Transition& transition : kTransitions) {
    if (transition.from == mode && transition.event == event) return &transition;
  }
  return nullptr;
}

}  // namespace limber::controller
