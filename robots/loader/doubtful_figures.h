// Figures of a robot.yaml that contradict each other: a wrong unit, two that are exchanged.
#pragma once

#include <string>
#include <vector>

#include "common/yaml_reader.h"
#include "robots/loader/robot.h"

namespace limber {

/// Notes, with file and line and what is likelier: friction that the motor could not overcome,
/// speeds and ends of no joint, currents and accelerations of no motor, VMAX and TMAX exchanged.
/// `yaml`: the robot.yaml that `robot` was read from. Set-up only.
std::vector<std::string> doubtful_figures(const YamlMap& yaml, const Robot& robot);

/// "; are these degrees? 2.09 rad/s": of a speed that no joint reaches, rad/s, or m/s if it
/// `slides`; else empty.
std::string doubtful_speed(double speed, bool slides);
/// Likewise of a length, m.
std::string doubtful_length(double length_m);

}  // namespace limber
