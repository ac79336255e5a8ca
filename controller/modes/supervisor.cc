#include "controller/modes/supervisor.h"

#include <array>
#include <limber/joint_command_t.hpp>

namespace limber::controller {
namespace {

constexpr std::array<const char*, kModes> kNotTaken = {
    "not taken in BOOT",   "not taken in INIT",      "not taken in IDLE",  "not taken in HOLD",
    "not taken in ACTIVE", "not taken in SOFT_STOP", "not taken in FAULT", "not taken in ESTOP"};

std::optional<Event> event_of(std::int8_t request) noexcept {
  switch (request) {
    case mode_request_t::REQUEST_IDLE:
      return Event::kRequestIdle;
    case mode_request_t::REQUEST_HOLD:
      return Event::kRequestHold;
    case mode_request_t::REQUEST_ACTIVE:
      return Event::kRequestActive;
    case mode_request_t::REQUEST_ACKNOWLEDGE:
      return Event::kRequestAcknowledge;
    default:
      return std::nullopt;
  }
}

}  // namespace

StateJudgement Supervisor::on_state(const joint_state_t& state) noexcept {
  const StateJudgement judgement = judge_.judge(state);
  if (judgement.ignored()) return judgement;
  if (judgement.first) raise(Event::kFirstState);
  if (judgement.new_session) raise(Event::kNewSession);
  if (!judgement.usable) {
    steady_ = 0;
    raise(Event::kStateInvalid);
    return judgement;
  }
  time_ns_ = state.time_ns;
  const bool enabling_failed = drive_state_ == joint_state_t::DRIVE_ENABLING &&
                               state.drive_state == joint_state_t::DRIVE_FAULT;
  drive_state_ = state.drive_state;
  stop_pressed_ = state.emergency_stop >= joint_state_t::STOP_PRESSED;
  slack_ = preload_.slack(state);
  if (stop_pressed_) raise(Event::kEstopPressed);
  // Drives that repeat their start-up after an acknowledgement tell no states until it is over.
  const bool silent_start =
      starting_ && judgement.silent && drive_state_ == joint_state_t::DRIVE_OFF;
  starting_ = powered_mode() && (drive_state_ == joint_state_t::DRIVE_CONFIGURING || silent_start);
  if (judgement.silent && !(starting_ && judgement.missed == 0)) raise(Event::kStateLost);
  if (drive_state_ != joint_state_t::DRIVE_FAULT) acknowledged_ = false;
  count_steady(judgement);
  watch_drives(enabling_failed);
  if (goal_ends_ns_ && time_ns_ >= *goal_ends_ns_) raise(Event::kClientSilent);
  if (time_ns_ - entered_ns_ >= kSoftStop_ns) raise(Event::kAtRest);  // of SOFT_STOP alone
  return judgement;
}

void Supervisor::count_steady(const StateJudgement& judgement) noexcept {
  const bool good = judgement.fresh && judgement.missed == 0;
  steady_ = good ? steady_ + 1 : 0;
  if (steady_ >= kSteadyStates) raise(Event::kSteadyStates);
}

// Enabling that fails is a new fault, which nobody has acknowledged.
void Supervisor::watch_drives(bool enabling_failed) noexcept {
  if (!powered_mode()) return;
  if (drives_on()) {
    engaged_ = true;
  } else if (engaged_ || enabling_failed) {
    raise(Event::kDriverFault);
  } else if (time_ns_ - entered_ns_ > kDrivesOnWithin_ns) {
    raise(Event::kDriveNotOn);
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
  const std::optional<Event> event = event_of(request.request);
  if (!event)
    return malformed("the request is none of idle, hold, active, stop, acknowledge, release");
  if (event == Event::kRequestAcknowledge && steady_ < kSteadyStates) {
    return {request_answer_t::REFUSED_CAUSE_REMAINS,
            "the cause is not gone: the states are not steady yet"};
  }
  if (event == Event::kRequestAcknowledge && stop_pressed_)
    return {request_answer_t::REFUSED_CAUSE_REMAINS,
            "the emergency stop is pressed, or its input is silent"};
  if (event == Event::kRequestActive && !engaged_)
    return {request_answer_t::REFUSED_MODE, "ACTIVE is entered from HOLD, drives on"};
  if (event == Event::kRequestActive && mode_ == Mode::kHold && slack_)
    return {
        request_answer_t::REFUSED_PRELOAD,
        "the springs between two motors are slack: HOLD winds them up (`preload` of JOINT_STATE, "
        "to preload_rad of robot.yaml); ask again when that is done"};
  if (!raise(*event))
    return {request_answer_t::REFUSED_MODE, kNotTaken[static_cast<std::size_t>(mode_)]};
  if (event == Event::kRequestAcknowledge) {
    reason_ = controller_status_t::REASON_NONE;
    reason_joint_ = -1;
    acknowledged_ = drive_state_ == joint_state_t::DRIVE_FAULT;
  }
  if (event == Event::kRequestIdle) idle_requested_ = true;
  take_lease(request.client);
  return {};
}

bool Supervisor::not_yet(const mode_request_t& request) const noexcept {
  if (request.request == mode_request_t::REQUEST_HOLD) {
    return mode_ == Mode::kBoot || mode_ == Mode::kInit;
  }
  return request.request == mode_request_t::REQUEST_ACTIVE && mode_ == Mode::kHold &&
         (!engaged_ || slack_);
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
  goal_ends_ns_.reset();
  idle_requested_ = false;
  if (!powered_mode()) engaged_ = false;
}

bool Supervisor::powered_mode() const noexcept {
  return mode_ == Mode::kHold || mode_ == Mode::kActive || mode_ == Mode::kSoftStop;
}

std::int8_t Supervisor::drive_request() const noexcept {
  const bool powered = drives_on() || drive_state_ == joint_state_t::DRIVE_ENABLING;
  if (powered_mode()) {
    if (drive_state_ == joint_state_t::DRIVE_OFF) return joint_command_t::REQUEST_ON;
    if (drives_hold() || drive_state_ == joint_state_t::DRIVE_FAULT) {
      return joint_command_t::REQUEST_ACKNOWLEDGE;
    }
    return joint_command_t::REQUEST_KEEP;
  }
  // The same fault, acknowledged once: the drives' start-up is repeated before they are wanted.
  if (mode_ == Mode::kIdle && acknowledged_) return joint_command_t::REQUEST_ACKNOWLEDGE;
  // Repeated until the drives are off: a single message may be lost.
  if (idle_requested_ && (powered || drives_hold())) return joint_command_t::REQUEST_OFF;
  // Drives that are on while nobody controls the arm shall hold it themselves.
  return powered ? joint_command_t::REQUEST_HOLD : joint_command_t::REQUEST_KEEP;
}

}  // namespace limber::controller
