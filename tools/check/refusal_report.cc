#include "tools/check/refusal_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <variant>

#include "common/problem_text.h"
#include "controller/arm_controller.h"
#include "controller/modes/state_judge.h"

namespace limber {
namespace {

// The controller counts states until it is ready; then a coarse step is enough.
constexpr std::int64_t kFineStates = 2 * controller::Supervisor::kSteadyStates;
constexpr std::int64_t kCoarse_ns = 10'000'000;
constexpr std::int64_t kPatience_ns = 6'000'000'000;  // more than requests wait for the drives

/// An arm that stands still, with drives that obey.
class StandingArm {
 public:
  StandingArm(const Robot& robot, const std::vector<double>& q) {
    state_.session = 1;
    state_.seq = -1;
    state_.period_ns = -1;
    state_.num_joints = static_cast<std::int8_t>(robot.size());
    state_.drive_state = joint_state_t::DRIVE_OFF;
    if (robot.has_tip_sensor) state_.sensor_state = joint_state_t::SENSOR_FRESH;
    const auto flags = controller::equipment_of(robot);
    for (std::size_t i = 0; i < q.size(); ++i) {
      state_.q[i] = state_.theta[i] = q[i];
      state_.preload[i] = static_cast<float>(robot.joints[i].transmission.preload_rad);
      state_.joint_flags[i] = flags[i] | joint_state_t::JOINT_FRESH | joint_state_t::JOINT_ENABLED;
    }
    fine_ns_ = static_cast<std::int64_t>(1e9 / robot.rate_hz);
  }

  const joint_state_t& next(const joint_command_t* answer) {
    if (answer != nullptr) obey(*answer);
    ++state_.seq;
    if (state_.period_ns > 0) state_.time_ns += state_.period_ns;
    state_.period_ns = state_.seq < kFineStates ? fine_ns_ : kCoarse_ns;
    for (int i = 0; i < state_.num_joints; ++i) state_.theta[i] += flicker_rad_;
    flicker_rad_ = -flicker_rad_;
    return state_;
  }

 private:
  void obey(const joint_command_t& answer) {
    switch (answer.request) {
      case joint_command_t::REQUEST_ON:
      case joint_command_t::REQUEST_ACKNOWLEDGE:
        state_.drive_state = joint_state_t::DRIVE_ON;
        break;
      case joint_command_t::REQUEST_OFF:
        state_.drive_state = joint_state_t::DRIVE_OFF;
        break;
      case joint_command_t::REQUEST_HOLD:
        state_.drive_state = joint_state_t::DRIVE_HOLD;
        break;
      default:
        break;
    }
    std::copy_n(answer.tau, kMaxJoints, state_.tau_applied);
    std::copy_n(answer.tau_preload, kMaxJoints, state_.tau_preload_applied);
    std::copy_n(answer.tau, kMaxJoints, state_.tau);
  }

  joint_state_t state_{};
  std::int64_t fine_ns_;
  double flicker_rad_ = 1e-9;  ///< of the encoders, which would else be taken for stopped
};

/// The part that can be foretold.
std::vector<TimedMessage> before_faults(const std::vector<TimedMessage>& timeline) {
  const auto fault = std::ranges::find_if(timeline, [](const TimedMessage& timed) {
    const auto* event = std::get_if<scenario_event_t>(&timed.message);
    return event != nullptr && event->kind == scenario_event_t::EVENT_FAULT;
  });
  return {timeline.begin(), fault};
}

constexpr std::array kKinds = {"mode", "goal", "gains"};

std::string line(const RequestOutcome& outcome, std::int64_t time_ns) {
  const char* kind = kKinds[static_cast<std::size_t>(outcome.kind)];
  const double time_s = static_cast<double>(time_ns) * 1e-9;
  if (!outcome.refusal)
    return fmt::format("{} at {:g} s: {}", kind, time_s, outcome.refusal.warning);
  const Problem* problem = find_problem(problems::kRequest, outcome.refusal.code);
  // The only check that depends on where the arm then is.
  const bool by_pose = outcome.refusal.code == request_answer_t::REFUSED_SPRINGS;
  return fmt::format("{} at {:g} s {}: {}: {}", kind, time_s,
                     by_pose ? "would be refused in the start pose" : "will be refused",
                     problem == nullptr ? "" : problem->code, outcome.refusal.reason);
}

}  // namespace

std::vector<std::string> doubtful_requests(const Scenario& scenario, const LoadedRobot& robot) {
  std::vector<std::string> lines;
  const std::vector<TimedMessage> timeline = before_faults(scenario.timeline);
  if (!robot.robot.has_drives || timeline.empty()) return lines;
  ArmControllerOptions options;
  options.measure_time = false;
  options.allow_unstable = scenario.allow_unstable;
  ArmController controller(robot, options);
  controller.set_timeline(&timeline);
  StandingArm arm(robot.robot, scenario.start_q);
  const joint_command_t* answer = nullptr;
  const std::int64_t end_ns = timeline.back().time_ns + kPatience_ns;
  while (controller.status().time_ns < end_ns &&
         controller.status().mode != controller_status_t::MODE_FAULT) {
    answer = &controller.step(arm.next(answer));
    for (const RequestOutcome& outcome : controller.timeline_outcomes()) {
      // Unstable gains are told by the report of the stiffness, as far as they are.
      const bool warned =
          outcome.refusal.warning != nullptr && outcome.kind == request_answer_t::KIND_GOAL;
      if (!outcome.refusal && !warned) continue;
      const auto entry = static_cast<std::size_t>(outcome.seq - 1);  // numbered by the loader
      lines.push_back(line(outcome, timeline[entry].time_ns));
    }
  }
  return lines;
}

}  // namespace limber
