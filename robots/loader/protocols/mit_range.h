// The key mit_range: what a count of the five numbers of an MIT command is worth.
#pragma once

#include "common/yaml_reader.h"
#include "robots/loader/robot.h"

namespace limber {

/// The mapping behind mit_range. Throws ConfigError.
CommandRange read_mit_range(const YamlMap& yaml);

}  // namespace limber
