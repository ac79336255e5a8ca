#include "controller/modes/supervisor.h"

#include <limber/joint_command_t.hpp>

namespace limber::controller {
namespace {

Refusal event_of(const mode_request_t& request, Event* event) noexcept {
  switch (request.request) {
    case mode_request_t::REQUEST_IDLE:
      *event = Event::kRequestIdle;
      return {};
    case mode_request_t::REQUEST_HOLD:
      *event = Event::kRequestHold;
      return {};
    case mode_request_t::REQUEST_ACTIVE:
      *event = Event::kRequestActive;
      return {};
    case mode_request_t::REQUEST_ACKNOWLEDGE:
      *event = Event::kRequestAcknowledge;
      return {};
    default:
      return {request_answer_t::REFUSED_MALFORMED,
              "the request is none of idle, hold, active, stop, acknowledge, release"};
  }
}

}  // namespace

StateJudgement Supervisor::on_state(const joint_state_t& state) noexcept {
  const StateJudgement judgement = judge_.judge(state);
  if (judgement.repeated) return judgement;
  if (judgement.first) raise(Event::kFirstState);
  if (judgement.new_session) raise(Event::kNewSession);
  if (!judgement.usable) {
    steady_ = 0;
    raise(Event::kStateInvalid);
    return judgement;
  }
  time_ns_ = state.time_ns;
  drive_state_ = state.drive_state;
  stop_pressed_ = state.emergency_stop >= joint_state_t::STOP_PRESSED;
  if (stop_pressed_) raise(Event::kEstopPressed);
  if (judgement.silent) raise(Event::kStateLost);
  if (drive_state_ != joint_state_t::DRIVE_FAULT) acknowledged_ = false;
  count_steady(judgement);
  watch_drives();
  if (mode_ == Mode::kSoftStop && time_ns_ - entered_ns_ >= kSoftStop_ns) raise(Event::kAtRest);
  return judgement;
}

void Supervisor::count_steady(const StateJudgement& judgement) noexcept {
  const bool good = judgement.fresh && judgement.missed == 0;
  if (!good) {
    steady_ = 0;
  } else if (steady_ < kSteadyStates) {
    ++steady_;
  }
  if (steady_ == kSteadyStates) raise(Event::kSteadyStates);
}

void Supervisor::watch_drives() noexcept {
  if (!powered_mode()) return;
  const bool on = drive_state_ == joint_state_t::DRIVE_ON;
  if (engaged_ && !on) {
    raise(Event::kDriverFault);
  } else if (!engaged_ && !on && time_ns_ - entered_ns_ > kDrivesOnWithin_ns) {
    raise(Event::kDriveNotOn);
  } else if (on) {
    engaged_ = true;
  }
}

Refusal Supervisor::on_mode(const mode_request_t& request) noexcept {
  if (request.request == mode_request_t::REQUEST_STOP) {  // from anybody
    raise(Event::kRequestStop);
    return {};
  }
  if (request.request == mode_request_t::REQUEST_RELEASE) {
    if (request.client == 0 || request.client != lease_)
      return {request_answer_t::REFUSED_LEASE, "the lease is not this client's"};
    lease_ = 0;
    return {};
  }
  if (const Refusal refusal = check_client(request.client)) return refusal;
  Event event{};
  if (const Refusal refusal = event_of(request, &event)) return refusal;
  if (event == Event::kRequestAcknowledge && steady_ < kSteadyStates) {
    return {request_answer_t::REFUSED_CAUSE_REMAINS,
            "the cause is not gone: the states are not steady yet"};
  }
  if (event == Event::kRequestAcknowledge && stop_pressed_)
    return {request_answer_t::REFUSED_CAUSE_REMAINS,
            "the emergency stop is pressed, or its input is silent"};
  if (event == Event::kRequestActive && !engaged_)
    return {request_answer_t::REFUSED_MODE, "ACTIVE is entered from HOLD, drives on"};
  if (!raise(event)) return {request_answer_t::REFUSED_MODE, "not in this mode"};
  if (event == Event::kRequestAcknowledge) {
    reason_ = controller_status_t::REASON_NONE;
    reason_joint_ = -1;
    acknowledged_ = true;
  }
  if (event == Event::kRequestIdle) idle_requested_ = true;
  take_lease(request.client);
  return {};
}

bool Supervisor::not_yet(const mode_request_t& request) const noexcept {
  if (request.request == mode_request_t::REQUEST_HOLD) {
    return mode_ == Mode::kBoot || mode_ == Mode::kInit;
  }
  return request.request == mode_request_t::REQUEST_ACTIVE && mode_ == Mode::kHold && !engaged_;
}

Refusal Supervisor::check_client(std::int64_t client) const noexcept {
  if (client == 0) return {request_answer_t::REFUSED_CLIENT, "client must not be 0"};
  if (lease_ == 0 || client == lease_ || lease_is_over()) return {};
  return {request_answer_t::REFUSED_LEASE,
          "another client holds the lease: until it releases it, or, outside ACTIVE, has requested "
          "nothing for 10 s; a stop is taken from anybody"};
}

bool Supervisor::lease_is_over() const noexcept {
  return mode_ != Mode::kActive && mode_ != Mode::kSoftStop &&
         time_ns_ - lease_renewed_ns_ > kLease_ns;
}

bool Supervisor::raise(Event event, int joint) noexcept {
  const Transition* transition = find_transition(mode_, event);
  if (transition == nullptr) return false;
  if (transition->reason != controller_status_t::REASON_NONE) {
    reason_ = transition->reason;
    reason_joint_ = joint;
  }
  if (transition->to == Mode::kInit || transition->to == Mode::kFault) steady_ = 0;
  if (transition->to != mode_) enter(transition->to);
  return true;
}

void Supervisor::enter(Mode mode) noexcept {
  mode_ = mode;
  entered_ns_ = time_ns_;
  idle_requested_ = false;
  if (!powered_mode()) engaged_ = false;
}

bool Supervisor::powered_mode() const noexcept {
  return mode_ == Mode::kHold || mode_ == Mode::kActive || mode_ == Mode::kSoftStop;
}

std::int8_t Supervisor::drive_request() const noexcept {
  const bool on = drive_state_ == joint_state_t::DRIVE_ON;
  const bool enabling = drive_state_ == joint_state_t::DRIVE_ENABLING;
  const bool holding =
      drive_state_ == joint_state_t::DRIVE_HOLD || drive_state_ == joint_state_t::DRIVE_DAMP;
  if (powered_mode()) {
    if (drive_state_ == joint_state_t::DRIVE_OFF) return joint_command_t::REQUEST_ON;
    if (holding || drive_state_ == joint_state_t::DRIVE_FAULT) {
      return joint_command_t::REQUEST_ACKNOWLEDGE;
    }
    return joint_command_t::REQUEST_KEEP;
  }
  // The same fault, acknowledged once: the drives' start-up is repeated before they are wanted.
  if (mode_ == Mode::kIdle && acknowledged_ && drive_state_ == joint_state_t::DRIVE_FAULT)
    return joint_command_t::REQUEST_ACKNOWLEDGE;
  // Repeated until the drives are off: a single message may be lost.
  if (idle_requested_ && (on || enabling || holding)) return joint_command_t::REQUEST_OFF;
  // Drives that are on while nobody controls the arm shall hold it themselves.
  return on || enabling ? joint_command_t::REQUEST_HOLD : joint_command_t::REQUEST_KEEP;
}

}  // namespace limber::controller
