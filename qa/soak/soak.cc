#include "qa/soak/soak.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/problem_text.h"
#include "drivers/drives_text.h"

namespace limber::soak {
namespace {

constexpr std::int64_t kUser = 7;
constexpr double kRecovery_s = 10.0;  // from the end of a fault until the arm works again
constexpr double kQuiet_s = 0.3;      // after a fault, before it is acknowledged
constexpr double kSettled_s = 1.0;    // until stand and hold have let go of the arm
constexpr double kAtRest = 0.05;      // of the velocity limit: the arm may be used again
constexpr int kAskEvery_cycles = 50;
constexpr double kWarm_s = 60.0;  // after this the process holds all that it needs
constexpr std::int64_t kGrowth_kB = 1024;

/// Whether a fault of a drive (scenario_event_t) can be the reason of a trip (joint_state_t). A
/// frozen encoder deceives the law, and what gives it away differs; it may be the jump at its end.
bool explains(int injected, int cause) {
  using State = joint_state_t;
  switch (injected) {
    case scenario_event_t::FAULT_SILENT:
      return cause == State::FAULT_REPLY_LOST;
    case scenario_event_t::FAULT_FROZEN_ENCODER:  // REQUESTED: by the controller, ENCODER_STOPPED
      return cause == State::FAULT_REQUESTED || cause == State::FAULT_FEEDBACK ||
             cause == State::FAULT_POSITION || cause == State::FAULT_VELOCITY ||
             cause == State::FAULT_REPLY_LOST || cause == State::FAULT_REPLY_INVALID;
    default:  // an error, or a watchdog that commands no longer feed
      return cause == State::FAULT_DRIVE_ERROR;
  }
}

Scenario empty_scenario() {
  Scenario scenario;
  scenario.name = "soak";
  return scenario;
}

template <typename Message>
Message from_user(Message message) {
  message.client = kUser;
  return message;
}

}  // namespace

Soak::Soak(const LoadedRobot& robot, std::uint64_t seed, Habit habit)
    : robot_(robot),
      scenario_(empty_scenario()),
      lab_(std::in_place, robot, scenario_),
      habit_(habit),
      user_(robot, seed, habit) {}

double Soak::time_s() const { return 1e-9 * static_cast<double>(lab_->time_ns()); }

const SoakResult& Soak::run(double arm_time_s, const std::function<bool()>& go_on) {
  const auto a_second = static_cast<std::int64_t>(robot_.robot.rate_hz);
  while (time_s() < arm_time_s && result_.violations.empty()) {
    cycle();
    if (result_.cycles % a_second != 0) continue;
    measure_process();
    if (!go_on()) break;
  }
  return result_;
}

void Soak::cycle() {
  lab_->step();
  ++result_.cycles;
  judge();
  if (phase_ == Phase::kWorking) {
    if (time_s() >= next_action_s_) act();
  } else if (time_s() >= fault_end_s_ + kQuiet_s && result_.cycles % kAskEvery_cycles == 0) {
    recover();
  }
}

void Soak::judge() {
  judge_numbers();
  judge_trip();
  if (phase_ == Phase::kWorking || time_s() <= std::max(phase_since_s_, fault_end_s_) + kRecovery_s)
    return;
  if (phase_ == Phase::kFaulty && cause_ != 0 && out_of_range()) return put_back();
  violated(fmt::format("the arm did not come back within {:g} s: mode {}, drives {}, fault {}",
                       kRecovery_s, lab_->controller_status().mode, lab_->state().drive_state,
                       lab_->state().fault));
}

/// An arm that fell swings on its springs for a while.
bool Soak::at_rest() const {
  const joint_state_t& state = lab_->state();
  for (int i = 0; i < robot_.robot.size(); ++i) {
    const double most = kAtRest * robot_.robot.joints[static_cast<std::size_t>(i)].velocity_limit;
    if (!(std::abs(state.v[i]) <= most && std::abs(state.theta_dot[i]) <= most)) return false;
  }
  return true;
}

bool Soak::out_of_range() const {
  const joint_state_t& state = lab_->state();
  return std::any_of(state.joint_flags, state.joint_flags + robot_.robot.size(),
                     [](int flags) { return (flags & joint_state_t::JOINT_OUT_OF_RANGE) != 0; });
}

/// An arm that fell so far that its drives may not be enabled is moved home by hand, without power.
void Soak::put_back() {
  ++result_.put_back;
  LabOptions options;
  options.first_cycle = result_.cycles;
  lab_.emplace(robot_, scenario_, options);
  phase_ = Phase::kStarting;
  phase_since_s_ = time_s();
}

void Soak::judge_numbers() {
  const joint_state_t& state = lab_->state();
  const joint_command_t& torque = lab_->torque();
  const sim_truth_t& truth = lab_->truth();
  for (int i = 0; i < robot_.robot.size(); ++i) {
    const double limit = robot_.robot.joints[static_cast<std::size_t>(i)].torque_limit_Nm;
    for (const double number : {state.q[i], state.v[i], state.tau[i], state.tau_applied[i],
                                torque.tau[i], torque.tau_gravity[i], truth.q[i]}) {
      if (!std::isfinite(number)) violated("a number is not finite");
    }
    if (!(std::abs(torque.tau[i]) <= limit)) violated("a torque is beyond its limit");
  }
  if (lab_->simulator().diverged() != 0) violated("the simulation diverged");
  if (state.seq != result_.cycles - 1) violated("a cycle was left out");
}

std::string Soak::trip_text() {
  const joint_state_t& state = lab_->state();
  const int fault = state.fault;
  const std::string joint =
      state.fault_joint < 0 ? ""
                            : robot_.robot.joints[static_cast<std::size_t>(state.fault_joint)].name;
  const std::string drives = drives_text(
      state.drive_state, fault, joint,
      lab_->driver().fault_text(fault, state.fault_joint, lab_->driver().fault_detail()));
  const int reason = lab_->controller_status().reason;
  if (find_problem(problems::kController, reason) == nullptr) return drives;
  return drives + "; controller: " + problem_text(problems::kController, reason, "", "");
}

void Soak::judge_trip() {
  const joint_state_t& state = lab_->state();
  const int fault = state.fault;
  if (phase_ == Phase::kFaulty) {
    if (cause_ != 0 || fault == 0) return;
    cause_ = fault;
    if (!explains(injected_, cause_))
      violated(fmt::format("fault {} of a drive led to cause {}", injected_, cause_));
    return;
  }
  const bool beyond =
      fault == joint_state_t::FAULT_POSITION || fault == joint_state_t::FAULT_VELOCITY;
  if (habit_ == Habit::kAnything && fault != joint_state_t::FAULT_NONE && !beyond) {
    ++result_.other_trips[fault];
    return put_back();
  }
  const bool tripped = phase_ == Phase::kWorking && state.drive_state != joint_state_t::DRIVE_ON;
  if (fault != joint_state_t::FAULT_NONE || tripped)
    violated("a trip without a cause: " + trip_text());
}

void Soak::act() {
  const Action action = user_.next_action();
  ++result_.actions[static_cast<std::size_t>(action)];
  const char* refusal = nullptr;
  switch (action) {
    case Action::kGoal:
      refusal = lab_->controller().on_goal(from_user(user_.goal()));
      break;
    case Action::kGains:
      refusal = lab_->controller().on_gains(from_user(user_.gains()));
      break;
    case Action::kPush:
      lab_->simulator().push(user_.push());
      break;
    case Action::kStop:
      request(mode_request_t::REQUEST_STOP);
      phase_ = Phase::kStarting;
      phase_since_s_ = time_s();
      break;
    case Action::kFault:
      inject();
  }
  if (refusal != nullptr) ++result_.refused[refusal];
  next_action_s_ = time_s() + user_.next_pause_s();
}

void Soak::inject() {
  const scenario_event_t event = user_.fault();
  if (!lab_->simulator().event(event)) return violated("the simulator refused a fault");
  injected_ = event.fault;
  cause_ = 0;
  phase_ = Phase::kFaulty;
  phase_since_s_ = time_s();
  fault_end_s_ = time_s() + event.duration_s;
}

/// As an operator would: asks for what comes next, until the arm works.
void Soak::recover() {
  using Status = controller_status_t;
  if (phase_ == Phase::kFaulty && cause_ == 0) return end_fault();  // bridged
  switch (lab_->controller_status().mode) {
    case Status::MODE_FAULT:
      return request(mode_request_t::REQUEST_ACKNOWLEDGE);
    case Status::MODE_IDLE:
      return request(must_restart_drives() ? mode_request_t::REQUEST_IDLE
                                           : mode_request_t::REQUEST_HOLD);
    case Status::MODE_HOLD:
      if (at_rest()) request(mode_request_t::REQUEST_ACTIVE);
      return;
    case Status::MODE_ACTIVE:
      return end_fault();
    default:
      return;
  }
}

/// A drive that gave up while the others hold is enabled again from the beginning, with all.
bool Soak::must_restart_drives() const {
  const joint_state_t& state = lab_->state();
  if (state.drive_state != joint_state_t::DRIVE_HOLD &&
      state.drive_state != joint_state_t::DRIVE_DAMP)
    return false;
  for (int i = 0; i < robot_.robot.size(); ++i) {
    if ((state.joint_flags[i] & joint_state_t::JOINT_ENABLED) == 0) return true;
  }
  return false;
}

void Soak::end_fault() {
  if (phase_ == Phase::kFaulty) {
    ++result_.trips[{injected_, cause_}];
    if (cause_ != 0) ++result_.recoveries;
    result_.longest_recovery_s = std::max(result_.longest_recovery_s, time_s() - fault_end_s_);
  }
  phase_ = Phase::kWorking;
  next_action_s_ = time_s() + kSettled_s + user_.next_pause_s();
}

void Soak::request(std::int8_t what) {
  mode_request_t request{};
  request.seq = ++requests_;
  request.client = kUser;
  request.request = what;
  lab_->controller().on_mode(request);
}

void Soak::violated(const std::string& what) {
  if (result_.violations.empty())
    result_.violations.push_back(fmt::format("at {:.3f} s: {}", time_s(), what));
}

void Soak::measure_process() {
  result_.size_end = process_size();
  if (time_s() < kWarm_s) result_.size_begin = result_.size_end;
  result_.size_most.resident_kB =
      std::max(result_.size_most.resident_kB, result_.size_end.resident_kB);
  result_.size_most.descriptors =
      std::max(result_.size_most.descriptors, result_.size_end.descriptors);
  if (result_.size_end.resident_kB > result_.size_begin.resident_kB + kGrowth_kB)
    violated(fmt::format("the process grew from {} to {} kB", result_.size_begin.resident_kB,
                         result_.size_end.resident_kB));
  if (result_.size_end.descriptors > result_.size_begin.descriptors)
    violated("descriptors are left open");
}

}  // namespace limber::soak
