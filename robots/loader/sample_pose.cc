#include "robots/loader/sample_pose.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/joints.h"

namespace limber {

std::vector<double> sample_pose(const Robot& robot, unsigned index) {
  std::vector<double> pose;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const JointConfig& joint = robot.joints[i];
    // Kronecker's low-discrepancy sequence: fills the range evenly, needs no generator. Square
    // roots of distinct primes are irrational with respect to each other.
    constexpr int kPrimes[kMaxJoints] = {2,  3,  5,  7,  11, 13, 17, 19,
                                         23, 29, 31, 37, 41, 43, 47, 53};
    const double share = std::fmod(0.5 + (index + 1) * std::sqrt(kPrimes[i]), 1.0);
    const double low = std::max(joint.position_min, -std::numbers::pi);
    const double high = std::min(joint.position_max, std::numbers::pi);
    pose.push_back(low <= high ? low + share * (high - low) : joint.home);
  }
  return pose;
}

}  // namespace limber
