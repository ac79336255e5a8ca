#include "scenarios/loader/values_yaml.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/unit_hint.h"

namespace limber {

int index_of(const std::string& word, const std::vector<std::string>& words) {
  return static_cast<int>(std::find(words.begin(), words.end(), word) - words.begin());
}

void read_three(const YamlMap& yaml, const std::string& key, Range range, double* values) {
  if (!yaml.has(key)) return;
  const auto given = yaml.numbers(key, 3, range);
  std::copy(given.begin(), given.end(), values);
}

/// Scales to length 1; refuses what is further from it than a rounded figure.
void normalise(const YamlMap& yaml, const std::string& key, double* values, int size) {
  double sum = 0.0;
  for (int i = 0; i < size; ++i) sum += values[i] * values[i];
  const double length = std::sqrt(sum);
  if (!(std::abs(length - 1.0) <= 1e-3))
    yaml.refuse(key, fmt::format("has length {:.6g}; expected 1", length));
  for (int i = 0; i < size; ++i) values[i] /= length;
}

void read_joint_pose(const YamlMap& yaml, const std::string& key, const Robot& robot, double* q) {
  const auto pose = yaml.numbers(key, robot.size(), {-1e3, 1e3});
  for (std::size_t i = 0; i < pose.size(); ++i) {
    const JointConfig& joint = robot.joints[i];
    if (!(pose[i] >= joint.position_min && pose[i] <= joint.position_max)) {
      const std::string unit = joint.type == JointType::kPrismatic ? "_m" : "_rad";
      yaml.refuse(key,
                  fmt::format("{} for {} is outside its limits {} to {}{}", pose[i], joint.name,
                              joint.position_min, joint.position_max,
                              unit_hint(unit, pose[i], joint.position_min, joint.position_max)));
    }
    q[i] = pose[i];
  }
}

}  // namespace limber
