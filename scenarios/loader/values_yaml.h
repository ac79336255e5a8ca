// Values that several entries of a scenario have in common.
#pragma once

#include <string>
#include <vector>

#include "common/yaml_reader.h"
#include "robots/loader/robot.h"

namespace limber {

/// What a scenario may ask for; the controller and the simulator accept no more either.
inline constexpr Range kForceRange_N = {-200.0, 200.0};
inline constexpr Range kTorqueRange_Nm = {-50.0, 50.0};
inline constexpr Range kPositionRange_m = {-10.0, 10.0};

/// Three numbers, if the key is there.
void read_three(const YamlMap& yaml, const std::string& key, Range range, double* values);

/// Scales to length 1; refuses what is further from it than a rounded figure is.
void normalise(const YamlMap& yaml, const std::string& key, double* values, int size);

/// Position of a word that is in the list.
int index_of(const std::string& word, const std::vector<std::string>& words);

/// One number a joint, within the joints' limits.
void read_joint_pose(const YamlMap& yaml, const std::string& key, const Robot& robot, double* q);

}  // namespace limber
