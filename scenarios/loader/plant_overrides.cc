#include "scenarios/loader/plant_overrides.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "common/suggest.h"

namespace limber {
namespace {

using Keys = std::vector<std::string>;

const Keys kArm = {"urdf", "gravity", "motors", "joints", "tip_sensor", "emergency_stop", "hand"};
const Keys kMotor = {"gear_ratio", "rotor_inertia", "rotor_torque_constant", "phase_resistance",
                     "actuator"};
const Keys kMounting = {"sign", "offset"};
const Keys kJoint = {"motor",    "sign",          "offset",        "antagonist",   "transmission",
                     "friction", "link_friction", "motor_encoder", "link_encoder", "torque_sensor"};
const Keys kHand = {"motor", "sign", "offset", "friction", "finger_mass", "grasp_point"};
const Keys kLinkEncoder = {"bias", "eccentricity", "noise", "delay"};

/// Names stand without their units, which follow after an underscore.
void allow(const YamlMap& map, const Keys& names) {
  for (const std::string& key : map.keys()) {
    const bool acts = std::any_of(names.begin(), names.end(), [&](const std::string& name) {
      return key == name || key.starts_with(name + "_");
    });
    if (acts) continue;
    map.refuse(key, fmt::format("cannot differ between robot.yaml and the plant: the simulated arm "
                                "and its sensors would be the same; what can: {}",
                                joined(names)));
  }
}

void allow_in(const YamlMap& map, const std::string& key, const Keys& names) {
  if (map.is_map(key)) allow(map.map(key), names);
}

}  // namespace

void check_plant_keys(const YamlMap& plant) {
  allow(plant, kArm);
  if (plant.is_map("motors")) {
    const YamlMap motors = plant.map("motors");
    for (const std::string& name : motors.keys()) allow_in(motors, name, kMotor);
  }
  allow_in(plant, "hand", kHand);
  if (!plant.is_map("joints")) return;
  const YamlMap joints = plant.map("joints");
  for (const std::string& name : joints.keys()) {
    if (!joints.is_map(name)) continue;
    const YamlMap joint = joints.map(name);
    allow(joint, kJoint);
    allow_in(joint, "antagonist", kMounting);
    allow_in(joint, "link_encoder", kLinkEncoder);
  }
}

void check_plant_sensors(const YamlMap& plant, const Robot& robot, const Robot& real) {
  for (int i = 0; i < robot.size(); ++i) {
    const JointConfig& believed = robot.joints[i];
    const auto need = [&](const char* sensor, bool there, bool in_plant) {
      if (there == in_plant) return;
      plant.map("joints")
          .map(believed.name)
          .refuse(sensor, fmt::format("robot.yaml has {} there; a drive reports what robot.yaml "
                                      "has, so give it there and only its errors here",
                                      there ? "one" : "none"));
    };
    need("link_encoder", believed.link_encoder.present, real.joints[i].link_encoder.present);
    need("torque_sensor", believed.torque_sensor.present, real.joints[i].torque_sensor.present);
  }
}

}  // namespace limber
