#include "robots/loader/robot_yaml.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "common/complaints.h"
#include "robots/loader/emergency_stop_yaml.h"
#include "robots/loader/hand_yaml.h"
#include "robots/loader/joint_yaml.h"
#include "robots/loader/motor_yaml.h"
#include "robots/loader/tip_sensor_yaml.h"

namespace limber {
namespace {

constexpr const char* kFormat = "limber-robot/1";

DefaultGains read_gains(const YamlMap& yaml, int n) {
  const Range joint_stiffness = {0.0, 1e4};
  DefaultGains gains;
  gains.K_q = yaml.numbers("K_q_Nm_per_rad", n, joint_stiffness, true);
  gains.joint_damping_ratio = yaml.number("joint_damping_ratio", {0.0, 2.0});
  gains.K_x_translation_N_per_m = yaml.number("K_x_translation_N_per_m", {0.0, 1e5});
  gains.K_x_rotation_Nm_per_rad = yaml.number("K_x_rotation_Nm_per_rad", {0.0, 1e4});
  gains.damping_ratio = yaml.number("damping_ratio", {0.0, 2.0});
  gains.K_null = yaml.numbers("K_null_Nm_per_rad", n, joint_stiffness, true);
  gains.D_null = yaml.numbers("D_null_Nms_per_rad", n, {0.0, 1e3}, true);
  yaml.finish();
  return gains;
}

void read_watchdog(const YamlMap& yaml, Robot* robot) {
  const double timeout_s = yaml.number("timeout_s", {0.002, 1.0});
  if (!(timeout_s * robot->rate_hz >= 2.0)) {
    yaml.refuse("timeout_s",
                fmt::format("{} is shorter than two cycles at {} Hz", timeout_s, robot->rate_hz));
  }
  const auto reaction = yaml.word("reaction", {"damp", "off"}) == "damp"
                            ? NodeWatchdogReaction::kDamp
                            : NodeWatchdogReaction::kOff;
  yaml.finish();
  const auto set = [&](JointConfig* joint) {
    joint->drive.watchdog_s = timeout_s;
    joint->drive.watchdog_reaction = reaction;
  };
  for (JointConfig& joint : robot->joints) set(&joint);
  if (robot->hand) set(&robot->hand->drive);
}

std::set<std::string> ignored_limits(const YamlMap& yaml) {
  std::set<std::string> ignored;
  if (!yaml.is_map("joints")) return ignored;
  const YamlMap joints = yaml.map("joints");
  for (const std::string& name : joints.keys()) {
    if (joints.is_map(name) && ignores_urdf_limits(joints.map(name))) ignored.insert(name);
  }
  return ignored;
}

}  // namespace

RobotHeader read_robot_header(const YamlMap& yaml) {
  yaml.word("format", {kFormat});
  RobotHeader header;
  header.name = yaml.name("name");
  yaml.text_or("description", "-");
  header.urdf = yaml.text("urdf");
  header.base = yaml.text("base");
  header.tip = yaml.text("tip");
  if (yaml.has("gravity_m_per_s2")) {
    const auto gravity = yaml.numbers("gravity_m_per_s2", 3, {-30.0, 30.0});
    std::copy(gravity.begin(), gravity.end(), header.gravity_R);
  }
  header.ignored_urdf_limits = ignored_limits(yaml);
  return header;
}

void read_robot_yaml(const YamlMap& yaml, Robot* robot) {
  Complaints complaints(yaml.file());
  robot->rate_hz = 1000.0;
  complaints.collect([&] { robot->rate_hz = yaml.number("rate_hz", {10.0, 10'000.0}); });
  complaints.collect([&] {
    robot->power_limit_W = yaml.number_or("power_limit_W", {1.0, 1e5}, robot->power_limit_W);
    robot->energy_limit_J = yaml.number_or("energy_limit_J", {0.1, 1e5}, robot->energy_limit_J);
  });
  std::map<std::string, DriveConfig> motors;
  const bool buses_known = complaints.collect([&] { robot->buses = read_buses(yaml); });
  const bool motors_known = complaints.collect([&] { motors = read_motors(yaml); });
  yaml.has("joints");
  if (buses_known && motors_known) complaints.collect([&] { read_joints(yaml, motors, robot); });
  if (yaml.has("hand") && buses_known && motors_known)
    complaints.collect([&] { read_hand(yaml.map("hand"), motors, robot); });
  if (yaml.has("tip_sensor") && buses_known)
    complaints.collect([&] { read_tip_sensor(yaml.map("tip_sensor"), robot); });
  if (yaml.has("emergency_stop") && buses_known)
    complaints.collect([&] { read_emergency_stop(yaml.map("emergency_stop"), robot); });
  complaints.collect([&] { read_watchdog(yaml.map("watchdog"), robot); });
  complaints.collect([&] { robot->gains = read_gains(yaml.map("gains"), robot->size()); });
  complaints.collect([&] { yaml.finish(); });
  complaints.throw_if_any();
  robot->has_drives = true;
}

}  // namespace limber
