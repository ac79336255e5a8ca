#include "scenarios/loader/world_yaml.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "scenarios/loader/values_yaml.h"

namespace limber {
namespace {

// By scenario_event_t::FAULT_*.
constexpr std::array kFaultWords = {"silent",        "frozen_encoder", "drive_error",
                                    "drop_commands", "pressed",        "hot"};
// That a joint can have.
const std::vector<std::string> kFaults = {"silent", "frozen_encoder", "drive_error",
                                          "drop_commands", "hot"};
constexpr double kLongestPush_s = 60.0;

}  // namespace

push_t read_push(const YamlMap& yaml, const LoadedRobot& robot) {
  push_t push{};
  push.id = static_cast<std::int32_t>(yaml.integer_or("id", 1, 1000, 1));
  if (yaml.has("link")) push.link = yaml.word("link", robot.segment_links);
  if (!yaml.has("force_N") && !yaml.has("torque_Nm")) {
    yaml.refuse(
        "'force_N' or 'torque_Nm' is missing: a push needs one of them, three numbers in "
        "base axes");
  }
  read_three(yaml, "force_N", kForceRange_N, push.wrench);
  read_three(yaml, "torque_Nm", kTorqueRange_Nm, push.wrench + 3);
  push.duration_s = yaml.number("for_s", {1e-3, kLongestPush_s});
  push.ramp_s = yaml.number_or("ramp_s", {0.0, kLongestPush_s}, 0.0);
  if (!(2.0 * push.ramp_s <= push.duration_s)) {
    yaml.refuse("ramp_s", fmt::format("{}: both edges must fit into for_s, {}", push.ramp_s,
                                      push.duration_s));
  }
  yaml.finish();
  return push;
}

scenario_event_t read_wall(const YamlMap& entry) {
  scenario_event_t event{};
  event.kind = scenario_event_t::EVENT_WALL;
  event.normal[2] = 1.0;
  if (!entry.is_map("wall")) {
    entry.word("wall", {"off"});
    return event;
  }
  const YamlMap yaml = entry.map("wall");
  const auto point = yaml.numbers("point_m", 3, kPositionRange_m);
  const auto normal = yaml.numbers("normal", 3, {-1.001, 1.001});
  std::copy(point.begin(), point.end(), event.point);
  std::copy(normal.begin(), normal.end(), event.normal);
  normalise(yaml, "normal", event.normal, 3);
  event.stiffness_N_per_m = yaml.number("stiffness_N_per_m", {1.0, 1e7});
  event.damping_Ns_per_m = yaml.number_or("damping_Ns_per_m", {0.0, 1e5}, 0.0);
  yaml.finish();
  return event;
}

scenario_event_t read_payload(const YamlMap& entry) {
  scenario_event_t event{};
  event.kind = scenario_event_t::EVENT_PAYLOAD;
  event.normal[2] = 1.0;
  if (!entry.is_map("payload")) {
    entry.word("payload", {"off"});
    return event;
  }
  const YamlMap yaml = entry.map("payload");
  event.payload_mass_kg = yaml.number("mass_kg", {0.0, 100.0});
  read_three(yaml, "position_m", {-1.0, 1.0}, event.payload_position);
  yaml.finish();
  return event;
}

namespace {

/// `input: emergency_stop`, in place of a joint.
void read_input_fault(const YamlMap& yaml, const Robot& robot, scenario_event_t* event) {
  yaml.word("input", {"emergency_stop"});
  if (!robot.emergency_stop)
    yaml.refuse("input", fmt::format("{} has no emergency stop in robot.yaml", robot.name));
  event->joint = scenario_event_t::NODE_EMERGENCY_STOP;
  event->fault = yaml.word("kind", {"pressed", "silent"}) == "silent"
                     ? scenario_event_t::FAULT_SILENT
                     : scenario_event_t::FAULT_PRESSED;
}

/// `sensor: tip`, in place of a joint: it can only fall silent.
void read_sensor_fault(const YamlMap& yaml, const Robot& robot, scenario_event_t* event) {
  yaml.word("sensor", {"tip"});
  if (!robot.has_tip_sensor)
    yaml.refuse("sensor", fmt::format("{} has no sensor at the tip", robot.name));
  yaml.word("kind", {"silent"});
  event->joint = scenario_event_t::NODE_TIP_SENSOR;
  event->fault = scenario_event_t::FAULT_SILENT;
}

void read_joint_fault(const YamlMap& yaml, const Robot& robot, scenario_event_t* event) {
  const std::vector<std::string> names = robot.driven_names();
  event->joint = index_of(yaml.word("joint", names), names);
  const std::string kind = yaml.word("kind", kFaults);
  event->fault =
      static_cast<std::int8_t>(std::ranges::find(kFaultWords, kind) - kFaultWords.begin());
}

}  // namespace

const char* fault_word(std::int8_t fault) { return kFaultWords[static_cast<std::size_t>(fault)]; }

scenario_event_t read_fault(const YamlMap& yaml, const Robot& robot) {
  scenario_event_t event{};
  event.kind = scenario_event_t::EVENT_FAULT;
  event.normal[2] = 1.0;
  if (yaml.has("sensor")) {
    read_sensor_fault(yaml, robot, &event);
  } else if (yaml.has("input")) {
    read_input_fault(yaml, robot, &event);
  } else {
    read_joint_fault(yaml, robot, &event);
  }
  event.duration_s = yaml.number_or("for_s", {0.0, 600.0}, 0.0);  // 0: for ever
  yaml.finish();
  return event;
}

}  // namespace limber
