#include "qa/soak/random_user.h"

#include <algorithm>

#include "controller/laws/registry.h"
#include "robots/loader/default_gains.h"

namespace limber::soak {
namespace {

/// Laws that hold a goal at the joints and need nothing but the joints' encoders, in every pose.
constexpr std::array kLaws = {"joint_pd", "joint_impedance", "pd_plus", "computed_torque",
                              "cartesian_impedance"};

constexpr double kMost_rad = 0.3;  // of a joint, from home
constexpr double kMostPush_N = 5.0;

}  // namespace

RandomUser::RandomUser(const LoadedRobot& robot, std::uint64_t seed, Habit habit)
    : robot_(robot), habit_(habit), random_(seed), any_(robot, &random_) {
  const unsigned available = controller::sensors_of(robot.robot);
  for (const char* name : kLaws) {
    const int law = controller::find_law(name);
    if (law < 0) continue;
    const auto& entry = controller::laws()[static_cast<std::size_t>(law)];
    if (controller::check_law(entry, available) == nullptr) laws_.emplace_back(name);
  }
}

double RandomUser::uniform(double low, double high) {
  return low + (high - low) * std::generate_canonical<double, 53>(random_);
}

Action RandomUser::next_action() {
  if (habit_ == Habit::kAnything)
    return below(30) == 0 ? Action::kStop : below(2) == 0 ? Action::kGoal : Action::kGains;
  constexpr std::array kOften = {Action::kGoal, Action::kGoal, Action::kGains, Action::kGains,
                                 Action::kPush, Action::kPush, Action::kStop,  Action::kFault};
  return kOften[below(kOften.size())];
}

double RandomUser::next_pause_s() {
  return habit_ == Habit::kAnything ? uniform(0.02, 1.0) : uniform(0.2, 2.0);
}

compliance_goal_t RandomUser::goal() {
  if (habit_ == Habit::kAnything) return any_.goal();
  compliance_goal_t goal{};
  goal.kind = compliance_goal_t::GOAL_JOINT;
  goal.num_joints = static_cast<std::int8_t>(robot_.robot.size());
  goal.duration_s = uniform(0.5, 2.0);
  for (int i = 0; i < robot_.robot.size(); ++i) {
    const JointConfig& joint = robot_.robot.joints[static_cast<std::size_t>(i)];
    goal.q[i] = std::clamp(joint.home + uniform(-kMost_rad, kMost_rad), joint.position_min,
                           joint.position_max);
  }
  return goal;
}

compliance_gains_t RandomUser::gains() {
  if (habit_ == Habit::kAnything) return any_.gains();
  compliance_gains_t gains = default_gains(robot_.robot);
  gains.law = laws_[below(laws_.size())];
  gains.ramp_s = uniform(0.1, 1.0);
  const double share = uniform(0.3, 1.5);
  for (auto& row : gains.K_x) {
    for (double& entry : row) entry *= share;
  }
  for (double& entry : gains.K_q) entry *= share;
  gains.damping_ratio = uniform(0.5, 1.0);
  gains.joint_damping_ratio = uniform(0.5, 1.0);
  return gains;
}

push_t RandomUser::push() {
  push_t push{};
  push.id = static_cast<std::int32_t>(1 + below(3));
  for (double* component = push.wrench; component < push.wrench + 3; ++component)
    *component = uniform(-kMostPush_N, kMostPush_N);
  push.ramp_s = uniform(0.05, 0.3);
  push.duration_s = 2.0 * push.ramp_s + uniform(0.0, 1.0);
  return push;
}

scenario_event_t RandomUser::fault() {
  scenario_event_t event{};
  event.kind = scenario_event_t::EVENT_FAULT;
  event.fault = static_cast<std::int8_t>(below(scenario_event_t::FAULT_DROP_COMMANDS + 1));
  event.joint = static_cast<std::int32_t>(below(robot_.robot.joints.size()));
  event.duration_s = below(4) == 0 ? 0.002 : uniform(0.01, 0.4);
  return event;
}

}  // namespace limber::soak
