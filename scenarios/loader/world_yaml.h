// `push:`, `wall:`, `payload:` and `fault:` of a scenario's timeline: what befalls the simulated
// arm.
#pragma once

#include <limber/push_t.hpp>
#include <limber/scenario_event_t.hpp>

#include "common/yaml_reader.h"
#include "robots/loader/load_robot.h"

namespace limber {

// Each reads the value of its key; messages are without seq. Set-up only.
push_t read_push(const YamlMap& yaml, const LoadedRobot& robot);
scenario_event_t read_fault(const YamlMap& yaml, const Robot& robot);

/// The word of scenario_event_t::FAULT_*.
const char* fault_word(std::int8_t fault);

// Each reads its key of the entry, as the value may be the word off.
scenario_event_t read_wall(const YamlMap& entry);
scenario_event_t read_payload(const YamlMap& entry);

}  // namespace limber
