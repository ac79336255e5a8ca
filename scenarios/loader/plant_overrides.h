// What of robot.yaml may be another in a scenario's `plant_overrides:`.
#pragma once

#include "common/yaml_reader.h"
#include "robots/loader/robot.h"

namespace limber {

/// Refuses keys without an effect on the simulated arm: settings that drives and controller have
/// from robot.yaml, limits that they keep, addresses. Throws ConfigError with file, line and key.
/// Set-up only.
void check_plant_keys(const YamlMap& plant);

/// The same for sensors that only one of the two has.
void check_plant_sensors(const YamlMap& plant, const Robot& robot, const Robot& real);

}  // namespace limber
