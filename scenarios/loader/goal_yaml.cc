#include "scenarios/loader/goal_yaml.h"

#include <algorithm>
#include <numbers>

#include "scenarios/loader/scenario.h"
#include "scenarios/loader/values_yaml.h"

namespace limber {
namespace {

constexpr Range kAngle = {-2.0 * std::numbers::pi, 2.0 * std::numbers::pi};

/// Which of the three ways to name a goal the entry uses; without any it is a wrench alone.
std::int8_t goal_kind(const YamlMap& yaml) {
  const bool offset = yaml.has("offset_m") || yaml.has("offset_rad");
  const bool pose = yaml.has("position_m") || yaml.has("quaternion_wxyz");
  const bool joints = yaml.has("joints_rad");
  const bool circle = yaml.has("circle_centre_m") || yaml.has("circle_axis");
  const bool wrench = yaml.has("force_N") || yaml.has("torque_Nm");
  if (offset + pose + joints + circle > 1) {
    yaml.refuse(
        "more than one goal; expected one of: offset_m with offset_rad, position_m with "
        "quaternion_wxyz, joints_rad, circle_centre_m with circle_axis");
  }
  if (offset) return compliance_goal_t::GOAL_OFFSET;
  if (pose) return compliance_goal_t::GOAL_POSE;
  if (joints) return compliance_goal_t::GOAL_JOINT;
  if (circle) return compliance_goal_t::GOAL_CIRCLE;
  if (wrench) return compliance_goal_t::GOAL_WRENCH;
  yaml.has("duration_s");
  yaml.has("valid_for_s");
  yaml.finish();  // a misspelt key is the likelier reason
  yaml.refuse(
      "no goal; expected offset_m, offset_rad, position_m with quaternion_wxyz, "
      "joints_rad, circle_centre_m with circle_axis, force_N or torque_Nm");
}

}  // namespace

compliance_goal_t read_goal(const YamlMap& yaml, const Robot& robot) {
  compliance_goal_t goal{};
  goal.client = kScenarioClient;
  goal.num_joints = static_cast<std::int8_t>(robot.size());
  goal.quat_BD[0] = 1.0;
  goal.kind = goal_kind(yaml);
  read_three(yaml, "offset_m", kPositionRange_m, goal.offset);
  read_three(yaml, "offset_rad", kAngle, goal.offset + 3);
  if (goal.kind == compliance_goal_t::GOAL_POSE) {
    const auto position = yaml.numbers("position_m", 3, kPositionRange_m);
    const auto quaternion = yaml.numbers("quaternion_wxyz", 4, {-1.001, 1.001});
    std::copy(position.begin(), position.end(), goal.p_BD);
    std::copy(quaternion.begin(), quaternion.end(), goal.quat_BD);
    normalise(yaml, "quaternion_wxyz", goal.quat_BD, 4);
  }
  if (goal.kind == compliance_goal_t::GOAL_JOINT)
    read_joint_pose(yaml, "joints_rad", robot, goal.q);
  if (goal.kind == compliance_goal_t::GOAL_CIRCLE) {
    const auto centre = yaml.numbers("circle_centre_m", 3, kPositionRange_m);
    const auto axis = yaml.numbers("circle_axis", 3, {-1.001, 1.001});
    std::copy(centre.begin(), centre.end(), goal.offset);
    std::copy(axis.begin(), axis.end(), goal.offset + 3);
    normalise(yaml, "circle_axis", goal.offset + 3, 3);
  }
  if (yaml.has("posture_rad")) {
    if (goal.kind != compliance_goal_t::GOAL_POSE && goal.kind != compliance_goal_t::GOAL_OFFSET)
      yaml.refuse("posture_rad", "goes with a goal of the tip only");
    read_joint_pose(yaml, "posture_rad", robot, goal.q);
    goal.use_posture = 1;
  }
  read_three(yaml, "force_N", kForceRange_N, goal.F_ff);
  read_three(yaml, "torque_Nm", kTorqueRange_Nm, goal.F_ff + 3);
  goal.duration_s = yaml.number_or("duration_s", {0.0, 600.0}, 0.0);
  goal.valid_for_s = yaml.number_or("valid_for_s", {0.0, 600.0}, 0.0);
  yaml.finish();
  return goal;
}

}  // namespace limber
