// Reads the stages of a joint: transmission, friction, sensors, torque loop.
#pragma once

#include <string>

#include "common/yaml_reader.h"
#include "robots/loader/robot.h"

namespace limber {

/// Endings of the keys of one joint.
struct JointUnits {
  std::string position, velocity, force, force_rate, stiffness, damping;
};
/// Rotary and continuous joints: _rad, _Nm ...; prismatic joints: _m, _N ...
const JointUnits& units_of(const JointConfig& joint);

FrictionConfig read_friction(const YamlMap& yaml, const JointUnits& units);

/// `transmission`, `friction`, `link_friction`, `link_encoder`, `torque_sensor` and `torque_loop`
/// of one joint; each may be left out. Throws ConfigError. Set-up only.
void read_joint_chain(const YamlMap& yaml, double rate_hz, JointConfig* joint);

}  // namespace limber
