// What of robot.yaml may be another in a scenario's `reality:`.
#pragma once

#include "common/yaml_reader.h"
#include "robots/loader/robot.h"

namespace limber {

/// Refuses keys without an effect on the simulated arm: settings that drives and controller have
/// from robot.yaml, limits that they keep, addresses. Throws ConfigError with file, line and key.
/// Set-up only.
void check_reality_keys(const YamlMap& reality);

/// The same for sensors that only one of the two has.
void check_reality_sensors(const YamlMap& reality, const Robot& robot, const Robot& real);

}  // namespace limber
