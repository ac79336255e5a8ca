#include "qa/soak/any_request.h"

#include <algorithm>
#include <array>

#include "controller/laws/registry.h"
#include "lcmtypes/gains_table.h"
#include "robots/loader/default_gains.h"

namespace limber::soak {
namespace {

constexpr double kTurn_rad = 6.283185307179586;  // of a continuous joint

}  // namespace

double AnyRequest::uniform(double low, double high) {
  return low + (high - low) * std::generate_canonical<double, 53>(random_);
}

compliance_gains_t AnyRequest::gains() {
  compliance_gains_t gains = default_gains(robot_.robot);
  const auto laws = controller::laws();
  const controller::LawEntry* law = nullptr;
  while (law == nullptr || law->demonstration) law = &laws[random_() % laws.size()];
  gains.law = law->name;
  gains.ramp_s = one_in(2) ? 0.0 : uniform(0.1, 1.0);
  for (int row = 0; row < 6; ++row) gains.K_x[row][row] *= one_in(5) ? 0.0 : scale();
  for (double& K : gains.K_q) K *= one_in(8) ? 0.0 : scale();
  gains.damping_ratio = uniform(0.2, 1.2);
  gains.joint_damping_ratio = uniform(0.2, 1.2);
  choose(&gains);
  return gains;
}

// One choice in four is another word than the default.
void AnyRequest::choose(compliance_gains_t* gains) {
  for (const GainRow& row : gain_table()) {
    const auto* field = std::get_if<std::int8_t compliance_gains_t::*>(&row.field);
    if (field == nullptr || !one_in(4)) continue;
    const GainWord& word = row.words[random_() % row.words.size()];
    if (!word.demonstration) gains->*(*field) = static_cast<std::int8_t>(word.value);
  }
}

compliance_goal_t AnyRequest::goal() {
  compliance_goal_t goal{};
  goal.num_joints = static_cast<std::int8_t>(robot_.robot.size());
  goal.quat_BD[0] = 1.0;
  goal.duration_s = one_in(2) ? 0.1 : uniform(0.1, 2.0);
  if (one_in(10)) goal.valid_for_s = uniform(0.1, 1.0);
  aim(&goal);
  if (one_in(3)) {
    for (int i = 0; i < 6; ++i) goal.F_ff[i] = i < 3 ? uniform(-60.0, 60.0) : uniform(-10.0, 10.0);
  }
  return goal;
}

void AnyRequest::aim(compliance_goal_t* goal) {
  constexpr std::array kKinds = {compliance_goal_t::GOAL_JOINT,  compliance_goal_t::GOAL_JOINT,
                                 compliance_goal_t::GOAL_OFFSET, compliance_goal_t::GOAL_OFFSET,
                                 compliance_goal_t::GOAL_WRENCH, compliance_goal_t::GOAL_CIRCLE};
  goal->kind = kKinds[random_() % kKinds.size()];
  const bool circle = goal->kind == compliance_goal_t::GOAL_CIRCLE;
  const double reach_m = circle ? 0.05 : 0.3;
  for (int i = 0; i < 6; ++i) goal->offset[i] = uniform(-1.0, 1.0) * (i < 3 ? reach_m : 1.0);
  for (int i = 0; i < goal->num_joints; ++i) {
    const JointConfig& joint = robot_.robot.joints[static_cast<std::size_t>(i)];
    const double low = std::max(joint.position_min, joint.home - kTurn_rad);
    const double high = std::min(joint.position_max, joint.home + kTurn_rad);
    goal->q[i] = one_in(4) ? (one_in(2) ? low : high) : uniform(low, high);
  }
}

}  // namespace limber::soak
