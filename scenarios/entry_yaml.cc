#include "scenarios/entry_yaml.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/suggest.h"
#include "scenarios/gains_yaml.h"

namespace limber {
namespace {

const std::vector<std::string> kKinds = {"mode", "gains",   "goal", "push",
                                         "wall", "payload", "fault"};
const std::vector<std::string> kModes = {"idle", "hold",        "active",
                                         "stop", "acknowledge", "release"};  // REQUEST_* order
const std::vector<std::string> kFaults = {"silent", "frozen_encoder", "drive_error",
                                          "drop_commands"};  // FAULT_* order
constexpr Range kForce = {-200.0, 200.0};
constexpr Range kTorque = {-50.0, 50.0};
constexpr Range kPosition = {-10.0, 10.0};
constexpr Range kAngle = {-2.0 * std::numbers::pi, 2.0 * std::numbers::pi};
constexpr double kLongestPush_s = 60.0;

std::int8_t index_of(const std::string& word, const std::vector<std::string>& words) {
  return static_cast<std::int8_t>(std::find(words.begin(), words.end(), word) - words.begin());
}

void read_three(const YamlMap& yaml, const std::string& key, Range range, double* values) {
  if (!yaml.has(key)) return;
  const auto given = yaml.numbers(key, 3, range);
  std::copy(given.begin(), given.end(), values);
}

/// Scales to length 1; refuses what is further from it than a rounded figure.
void normalise(const YamlMap& yaml, const std::string& key, double* values, int size) {
  double sum = 0.0;
  for (int i = 0; i < size; ++i) sum += values[i] * values[i];
  const double length = std::sqrt(sum);
  if (!(std::abs(length - 1.0) <= 1e-3))
    yaml.refuse(key, fmt::format("has length {:.6g}; expected 1", length));
  for (int i = 0; i < size; ++i) values[i] /= length;
}

void read_joint_pose(const YamlMap& yaml, const std::string& key, const Robot& robot, double* q) {
  const auto pose = yaml.numbers(key, robot.size(), {-1e3, 1e3});
  for (std::size_t i = 0; i < pose.size(); ++i) {
    const JointConfig& joint = robot.joints[i];
    if (!(pose[i] >= joint.position_min && pose[i] <= joint.position_max)) {
      yaml.refuse(key, fmt::format("{} for {} is outside its limits {} to {}", pose[i], joint.name,
                                   joint.position_min, joint.position_max));
    }
    q[i] = pose[i];
  }
}

/// Which of the three ways to name a goal the entry uses; without any it is a wrench alone.
std::int8_t goal_kind(const YamlMap& yaml) {
  const bool offset = yaml.has("offset_m") || yaml.has("offset_rad");
  const bool pose = yaml.has("position_m") || yaml.has("quaternion_wxyz");
  const bool joints = yaml.has("joints_rad");
  const bool wrench = yaml.has("force_N") || yaml.has("torque_Nm");
  if (offset + pose + joints > 1) {
    yaml.refuse(
        "more than one goal; expected one of: offset_m with offset_rad, position_m with "
        "quaternion_wxyz, joints_rad");
  }
  if (offset) return compliance_goal_t::GOAL_OFFSET;
  if (pose) return compliance_goal_t::GOAL_POSE;
  if (joints) return compliance_goal_t::GOAL_JOINT;
  if (wrench) return compliance_goal_t::GOAL_WRENCH;
  yaml.has("duration_s");
  yaml.finish();  // a misspelt key is the likelier reason
  yaml.refuse(
      "no goal; expected offset_m, offset_rad, position_m with quaternion_wxyz, "
      "joints_rad, force_N or torque_Nm");
}

compliance_goal_t read_goal(const YamlMap& yaml, const Robot& robot) {
  compliance_goal_t goal{};
  goal.client = kScenarioClient;
  goal.num_joints = static_cast<std::int8_t>(robot.size());
  goal.quat_BD[0] = 1.0;
  goal.kind = goal_kind(yaml);
  read_three(yaml, "offset_m", kPosition, goal.offset);
  read_three(yaml, "offset_rad", kAngle, goal.offset + 3);
  if (goal.kind == compliance_goal_t::GOAL_POSE) {
    const auto position = yaml.numbers("position_m", 3, kPosition);
    const auto quaternion = yaml.numbers("quaternion_wxyz", 4, {-1.001, 1.001});
    std::copy(position.begin(), position.end(), goal.p_BD);
    std::copy(quaternion.begin(), quaternion.end(), goal.quat_BD);
    normalise(yaml, "quaternion_wxyz", goal.quat_BD, 4);
  }
  if (goal.kind == compliance_goal_t::GOAL_JOINT)
    read_joint_pose(yaml, "joints_rad", robot, goal.q);
  if (yaml.has("posture_rad")) {
    if (goal.kind != compliance_goal_t::GOAL_POSE && goal.kind != compliance_goal_t::GOAL_OFFSET)
      yaml.refuse("posture_rad", "goes with a goal of the tip only");
    read_joint_pose(yaml, "posture_rad", robot, goal.q);
    goal.use_posture = 1;
  }
  read_three(yaml, "force_N", kForce, goal.F_ff);
  read_three(yaml, "torque_Nm", kTorque, goal.F_ff + 3);
  goal.duration_s = yaml.number_or("duration_s", {0.0, 600.0}, 0.0);
  yaml.finish();
  return goal;
}

push_t read_push(const YamlMap& yaml, const LoadedRobot& robot) {
  push_t push{};
  push.id = static_cast<std::int32_t>(yaml.integer_or("id", 1, 1000, 1));
  if (yaml.has("link")) push.link = yaml.word("link", robot.segment_links);
  if (!yaml.has("force_N") && !yaml.has("torque_Nm")) {
    yaml.refuse(
        "'force_N' or 'torque_Nm' is missing: a push needs one of them, three numbers in "
        "base axes");
  }
  read_three(yaml, "force_N", kForce, push.wrench);
  read_three(yaml, "torque_Nm", kTorque, push.wrench + 3);
  push.duration_s = yaml.number("for_s", {1e-3, kLongestPush_s});
  push.ramp_s = yaml.number_or("ramp_s", {0.0, kLongestPush_s}, 0.0);
  if (!(2.0 * push.ramp_s <= push.duration_s)) {
    yaml.refuse("ramp_s", fmt::format("{}: both edges must fit into for_s, {}", push.ramp_s,
                                      push.duration_s));
  }
  yaml.finish();
  return push;
}

scenario_event_t read_wall(const YamlMap& parent) {
  scenario_event_t event{};
  event.kind = scenario_event_t::EVENT_WALL;
  event.normal[2] = 1.0;
  if (!parent.is_map("wall")) {
    parent.word("wall", {"off"});
    return event;
  }
  const YamlMap yaml = parent.map("wall");
  const auto point = yaml.numbers("point_m", 3, kPosition);
  const auto normal = yaml.numbers("normal", 3, {-1.001, 1.001});
  std::copy(point.begin(), point.end(), event.point);
  std::copy(normal.begin(), normal.end(), event.normal);
  normalise(yaml, "normal", event.normal, 3);
  event.stiffness_N_per_m = yaml.number("stiffness_N_per_m", {1.0, 1e7});
  event.damping_Ns_per_m = yaml.number_or("damping_Ns_per_m", {0.0, 1e5}, 0.0);
  yaml.finish();
  return event;
}

scenario_event_t read_payload(const YamlMap& parent) {
  scenario_event_t event{};
  event.kind = scenario_event_t::EVENT_PAYLOAD;
  event.normal[2] = 1.0;
  if (!parent.is_map("payload")) {
    parent.word("payload", {"off"});
    return event;
  }
  const YamlMap yaml = parent.map("payload");
  event.payload_mass_kg = yaml.number("mass_kg", {1e-3, 100.0});
  read_three(yaml, "position_m", {-1.0, 1.0}, event.payload_position);
  yaml.finish();
  return event;
}

scenario_event_t read_fault(const YamlMap& yaml, const Robot& robot) {
  std::vector<std::string> names;
  for (const JointConfig& joint : robot.joints) names.push_back(joint.name);
  scenario_event_t event{};
  event.kind = scenario_event_t::EVENT_FAULT;
  event.normal[2] = 1.0;
  event.joint = index_of(yaml.word("joint", names), names);
  event.fault = index_of(yaml.word("kind", kFaults), kFaults);
  event.duration_s = yaml.number_or("for_s", {0.0, 600.0}, 0.0);  // 0: for ever
  yaml.finish();
  return event;
}

ScenarioMessage read_message(const YamlMap& yaml, const std::string& kind, EntryContext* context) {
  if (kind == "mode")
    return std::get<mode_request_t>(
        mode_at(0.0, index_of(yaml.word("mode", kModes), kModes)).message);
  if (kind == "gains") {
    read_gains_entry(yaml.map("gains"), context->robot.robot, &context->gains);
    return context->gains;
  }
  if (kind == "goal") return read_goal(yaml.map("goal"), context->robot.robot);
  if (kind == "push") return read_push(yaml.map("push"), context->robot);
  if (kind == "wall") return read_wall(yaml);
  if (kind == "payload") return read_payload(yaml);
  return read_fault(yaml.map("fault"), context->robot.robot);
}

}  // namespace

TimedMessage mode_at(double time_s, std::int8_t request) {
  mode_request_t message{};
  message.client = kScenarioClient;
  message.request = request;
  return {std::llround(time_s * 1e9), message};
}

TimedMessage read_entry(const YamlMap& yaml, EntryContext* context) {
  const double at_s = yaml.number("at_s", {0.0, context->duration_s});
  std::vector<std::string> there;
  for (const std::string& kind : kKinds) {
    if (yaml.has(kind)) there.push_back(kind);
  }
  yaml.finish();
  if (there.size() != 1) {
    yaml.refuse(fmt::format("an entry holds at_s and exactly one of: {}; found {}", joined(kKinds),
                            there.empty() ? "none" : joined(there)));
  }
  return {std::llround(at_s * 1e9), read_message(yaml, there.front(), context)};
}

}  // namespace limber
