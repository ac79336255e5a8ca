// The `motors:` and `buses:` sections of robot.yaml.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/yaml_reader.h"
#include "robots/loader/robot.h"

namespace limber {

/// The fields of DriveConfig that belong to a motor type: range, gear, rotor, constants. Torques,
/// inertia and damping are brought to the joint side:
///   B = N^2 I_rotor,   Kt = N kt,   d = (2/3) kt^2 N^2 / R.
/// d is the damping of shorted phases: with amplitude-invariant currents tau = kt iq, the back-EMF
/// on the q axis is (2/3) kt w, so iq = -(2/3) kt w / R with R the resistance of one phase.
/// What only motors of one protocol have is read in protocols/. Set-up only.
std::map<std::string, DriveConfig> read_motors(const YamlMap& yaml);

std::vector<BusConfig> read_buses(const YamlMap& yaml);

}  // namespace limber
