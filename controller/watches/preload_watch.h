// Are the springs between two motors wound up, so that the joint can carry and be moved?
#pragma once

#include <array>
#include <limber/joint_state_t.hpp>
#include <limits>

#include "common/joints.h"
#include "robots/loader/robot.h"

namespace limber::controller {

/// Without preload the link hangs between slack springs, and falls until one of them is stretched.
/// HOLD winds them up to robot.yaml's preload_rad; no law shall move the arm before. More preload
/// than that is no reason to wait.
class PreloadWatch {
 public:
  /// May be missing, as a share of preload_max_rad: friction, springs that are not quite those of
  /// robot.yaml.
  static constexpr double kMissing = 0.1;

  /// No joint with two motors.
  PreloadWatch() = default;
  /// For set-up.
  explicit PreloadWatch(const Robot& robot) {
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
      const JointConfig& joint = robot.joints[i];
      const TransmissionConfig& springs = joint.transmission;
      if (joint.has_antagonist)
        least_rad_[i] = springs.preload_rad - kMissing * springs.preload_max_rad;
    }
  }

  /// May be called in the cycle.
  bool slack(const joint_state_t& state) const noexcept {
    for (int i = 0; i < state.num_joints; ++i) {
      if (!(state.preload[i] >= least_rad_[static_cast<std::size_t>(i)])) return true;
    }
    return false;
  }

 private:
  static constexpr auto kNone = [] {
    std::array<double, kMaxJoints> least{};
    least.fill(-std::numeric_limits<double>::infinity());
    return least;
  }();
  std::array<double, kMaxJoints> least_rad_ = kNone;
};

}  // namespace limber::controller
