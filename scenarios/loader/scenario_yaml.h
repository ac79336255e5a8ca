// The reading of scenario.h for a scenario that is in memory already, or is read once for all of
// it. YamlMap::file() stands for the path: what is relative is so to its folder.
#pragma once

#include <string>
#include <vector>

#include "common/yaml_reader.h"
#include "scenarios/loader/scenario.h"

namespace limber {

// As their namesakes in scenario.h. Set-up only; all throw ConfigError.
std::string scenario_robot(const YamlMap& yaml, std::string* note = nullptr);
std::vector<std::string> scenario_laws(const YamlMap& yaml);
Scenario load_scenario(const YamlMap& yaml, const LoadedRobot& robot, const LawCatalog* laws);

}  // namespace limber
