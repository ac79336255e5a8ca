// What a scenario has for an arm with a hand: its goals, and things to grasp.
#pragma once

#include <limber/hand_goal_t.hpp>
#include <vector>

#include "common/yaml_reader.h"
#include "robots/loader/robot.h"
#include "scenarios/loader/object_config.h"

namespace limber {

/// `hand:` of a timeline entry. Throws ConfigError; set-up only, as the next.
hand_goal_t read_hand_goal(const YamlMap& yaml, const Robot& robot);

/// `objects:` of the scenario; none without.
std::vector<ObjectConfig> read_objects(const YamlMap& yaml, const Robot& robot);

}  // namespace limber
