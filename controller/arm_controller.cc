#include "controller/arm_controller.h"

#include <algorithm>
#include <optional>

#include "common/clock.h"
#include "common/config_error.h"
#include "controller/supervisor.h"
#include "controller/torque_cycle.h"
#include "lcmtypes/channels.h"

namespace limber {
namespace {

using namespace controller;

constexpr std::int64_t kLongestStep = 3;  // periods

/// What the torque cycle is to do in a mode.
enum class Activity { kRest, kHold, kLaw, kStop };

Activity activity_of(const Supervisor& supervisor) noexcept {
  if (!supervisor.engaged()) return Activity::kRest;
  switch (supervisor.mode()) {
    case Mode::kActive:
      return Activity::kLaw;
    case Mode::kSoftStop:
      return Activity::kStop;
    default:
      return Activity::kHold;
  }
}

const LoadedRobot& controllable(const LoadedRobot& robot) {
  if (!robot.robot.has_drives) {
    throw ConfigError(robot.robot.name +
                      ": this robot has no drives (no robot.yaml), so there is " +
                      "nothing to control");
  }
  return robot;
}

}  // namespace

struct ArmController::Impl {
  Impl(const LoadedRobot& robot, const ArmControllerOptions& given)
      : options(given),
        supervisor(robot.robot.size(), given.bridged_cycles, equipment_of(robot.robot)),
        cycle(controllable(robot), given.law) {
    answer.controller = options.controller;
    answer.num_joints = static_cast<std::int16_t>(robot.robot.size());
    status.controller = options.controller;
  }

  void apply_timeline(std::int64_t time_ns) noexcept;
  void follow_mode() noexcept;
  void control(std::int64_t missed) noexcept;
  void rest() noexcept;
  void write_answer(const joint_state_t& state) noexcept;
  void write_status(std::int64_t started_ns) noexcept;

  const char* on_mode(const mode_request_t& request) noexcept;
  const char* on_goal(const compliance_goal_t& goal) noexcept;
  const char* on_gains(const compliance_gains_t& gains) noexcept;
  const char* counted(const char* reason) noexcept {
    if (reason != nullptr) ++status.requests_refused;
    return reason;
  }

  ArmControllerOptions options;
  Supervisor supervisor;
  TorqueCycle cycle;
  Activity activity = Activity::kRest;
  std::optional<Timeline> timeline;
  double period_s = 0.0;
  joint_torque_t answer{};
  controller_status_t status{};
};

void ArmController::Impl::apply_timeline(std::int64_t time_ns) noexcept {
  if (!timeline) return;
  while (const ScenarioMessage* message = timeline->due(time_ns)) {
    if (const auto* request = std::get_if<mode_request_t>(message)) counted(on_mode(*request));
    if (const auto* goal = std::get_if<compliance_goal_t>(message)) counted(on_goal(*goal));
    if (const auto* gains = std::get_if<compliance_gains_t>(message)) counted(on_gains(*gains));
  }
}

void ArmController::Impl::follow_mode() noexcept {
  const Activity before = activity;
  activity = activity_of(supervisor);
  if (activity == before) return;
  if (before == Activity::kRest && activity != Activity::kRest) {
    // The first torque is the one present.
    cycle.rest(cycle.tau_applied(), false, PreloadAtRest::kAsSent);
  }
  if (activity == Activity::kHold) cycle.hold();
  if (activity == Activity::kLaw) cycle.activate();
  if (activity == Activity::kStop) {
    cycle.stop_goal(static_cast<double>(Supervisor::kSoftStop_ns) * 1e-9);
  }
}

void ArmController::Impl::control(std::int64_t missed) noexcept {
  // After a longer gap the goal goes on from where it was, not from where it would be.
  const std::int64_t periods = std::min(missed, kLongestStep - 1) + 1;
  if (!cycle.control(static_cast<double>(periods) * period_s)) {
    supervisor.raise(Event::kTorqueInvalid);
    follow_mode();
  }
}

void ArmController::Impl::rest() noexcept {
  const Mode mode = supervisor.mode();
  const bool latched = mode == Mode::kFault || mode == Mode::kEstop;
  if (supervisor.powered_mode()) {
    // The drives are still coming, with no torque; or they hold by themselves, and the springs.
    const bool held = supervisor.drives_hold();
    cycle.rest(cycle.tau_applied(), false,
               held ? PreloadAtRest::kWound : PreloadAtRest::kReleased);  // no wind-up
  } else if (latched || supervisor.drives_carry()) {
    cycle.rest(cycle.gravity(), supervisor.drives_on(), PreloadAtRest::kWound);
  } else {
    cycle.rest(VectorJ::Zero(answer.num_joints), supervisor.drives_on(), PreloadAtRest::kReleased);
  }
}

void ArmController::Impl::write_answer(const joint_state_t& state) noexcept {
  answer.state_seq = state.seq;
  answer.time_ns = state.time_ns;
  answer.session = state.session;
  answer.request = supervisor.drive_request();
  answer.mode = static_cast<std::int8_t>(supervisor.mode());
  const int n = answer.num_joints;
  Eigen::Map<VectorJ>(answer.tau, n) = cycle.torque();
  Eigen::Map<VectorJ>(answer.tau_preload, n) = cycle.preload_torque();
  Eigen::Map<VectorJ>(answer.tau_gravity, n) = cycle.gravity();
}

void ArmController::Impl::write_status(std::int64_t started_ns) noexcept {
  if (answer.state_seq % channels::kControllerStatusEvery == 0)
    ++status.seq;  // those that are published
  status.time_ns = answer.time_ns;
  status.session = answer.session;
  status.state_seq = answer.state_seq;
  status.mode = answer.mode;
  status.reason = supervisor.reason();
  status.states_received = supervisor.states().received();
  status.states_lost = supervisor.states().lost();
  cycle.describe(&status);
  if (!options.measure_time) return;
  status.cycle_ns = monotonic_ns() - started_ns;
  status.cycle_max_ns = std::max(status.cycle_max_ns, status.cycle_ns);
}

const char* ArmController::Impl::on_mode(const mode_request_t& request) noexcept {
  const char* reason = supervisor.on_mode(request);
  follow_mode();
  return reason;
}

const char* ArmController::Impl::on_goal(const compliance_goal_t& goal) noexcept {
  if (const char* reason = supervisor.refuse_client(goal.client)) return reason;
  if (supervisor.mode() != Mode::kActive) return "goals are taken in ACTIVE";
  if (const char* reason = cycle.set_goal(goal)) return reason;
  supervisor.take_lease(goal.client);
  return nullptr;
}

const char* ArmController::Impl::on_gains(const compliance_gains_t& gains) noexcept {
  if (const char* reason = supervisor.refuse_client(gains.client)) return reason;
  if (const char* reason = cycle.set_gains(gains, activity == Activity::kLaw)) return reason;
  supervisor.take_lease(gains.client);
  return nullptr;
}

ArmController::ArmController(const LoadedRobot& robot, const ArmControllerOptions& options)
    : impl_(std::make_unique<Impl>(robot, options)) {}

ArmController::~ArmController() = default;

const joint_torque_t& ArmController::step(const joint_state_t& state) noexcept {
  Impl& self = *impl_;
  const std::int64_t started_ns = self.options.measure_time ? monotonic_ns() : 0;
  const StateJudgement judgement = self.supervisor.on_state(state);
  if (judgement.repeated) return self.answer;
  if (judgement.new_session && self.timeline) self.timeline->rewind();

  if (judgement.new_session || judgement.silent) self.cycle.restart();
  if (judgement.usable) {
    self.period_s = static_cast<double>(state.period_ns) * 1e-9;
    self.cycle.measure(state);
    self.follow_mode();
    self.apply_timeline(state.time_ns);
  }
  self.follow_mode();
  if (self.activity != Activity::kRest) self.control(judgement.missed);
  if (self.activity == Activity::kRest) self.rest();

  self.write_answer(state);
  self.write_status(started_ns);
  return self.answer;
}

void ArmController::set_timeline(const std::vector<TimedMessage>* timeline) noexcept {
  impl_->timeline.emplace(timeline);
}

const char* ArmController::on_mode(const mode_request_t& request) noexcept {
  return impl_->counted(impl_->on_mode(request));
}
const char* ArmController::on_goal(const compliance_goal_t& goal) noexcept {
  return impl_->counted(impl_->on_goal(goal));
}
const char* ArmController::on_gains(const compliance_gains_t& gains) noexcept {
  return impl_->counted(impl_->on_gains(gains));
}

void ArmController::on_silence() noexcept {
  impl_->supervisor.raise(Event::kStateLost);
  impl_->follow_mode();
  ++impl_->status.seq;
  impl_->status.mode = static_cast<std::int8_t>(impl_->supervisor.mode());
  impl_->status.reason = impl_->supervisor.reason();
}

const controller_status_t& ArmController::status() const noexcept { return impl_->status; }

std::vector<std::string> law_names() {
  std::vector<std::string> names;
  for (const LawEntry& entry : laws()) names.emplace_back(entry.name);
  return names;
}

}  // namespace limber
