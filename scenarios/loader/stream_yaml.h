// Entry `stream` of a scenario: targets with times.
#pragma once

#include <limber/target_stream_t.hpp>

#include "common/yaml_reader.h"
#include "robots/loader/robot.h"

namespace limber {

/// Checks form and counts; what the arm may follow is the controller's to check. Throws
/// ConfigError.
target_stream_t read_stream(const YamlMap& yaml, const Robot& robot);

}  // namespace limber
