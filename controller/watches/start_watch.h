// Does the arm stay where it is held, in the first second after its drives came on?
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limber/joint_state_t.hpp>
#include <optional>

#include "common/joints.h"
#include "robots/loader/robot.h"

namespace limber::controller {

/// A joint with the wrong sign or another joint's motor, or a model whose gravity is wrong, moves
/// away as soon as the controller holds it. After a second in HOLD, or a request of ACTIVE, the arm
/// has been moved by intent, and nothing is checked.
class StartWatch {
 public:
  static constexpr double kMost = 0.1;  ///< motor side, rad (m for prismatic joints)
  /// Of a joint with springs, which give way under the weight until its motors have wound them, and
  /// of one that starts closer to its end than kNearEnd, where the soft wall pushes it inwards.
  static constexpr double kMostPushed = 0.3;
  static constexpr double kNearEnd = 0.1;
  /// An arm that swings when its drives come on moves on for so long at its fastest joint's speed.
  static constexpr double kStopping_s = 0.3;
  static constexpr std::int64_t kWatched_ns = 1'000'000'000;

  /// For set-up.
  explicit StartWatch(const Robot& robot) {
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
      const JointConfig& joint = robot.joints[i];
      joints_[i].elastic = !joint.rigid();
      joints_[i].least_free = joint.position_min + kNearEnd;
      joints_[i].most_free = joint.position_max - kNearEnd;
    }
  }

  // May be called in the cycle.

  /// The drives follow from this state on.
  void begin(const joint_state_t& state) noexcept {
    double fastest = 0.0;
    for (int i = 0; i < state.num_joints; ++i)
      fastest = std::max(fastest, std::abs(state.theta_dot[i]));
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      Joint& joint = joints_[i];
      joint.start = state.theta[i];
      const bool free = joint.start >= joint.least_free && joint.start <= joint.most_free;
      joint.most = (joint.elastic || !free ? kMostPushed : kMost) + kStopping_s * fastest;
    }
    start_ns_ = state.time_ns;
  }
  void end() noexcept { start_ns_.reset(); }

  /// The joint that has moved away; -1: none.
  int strayed(const joint_state_t& state) noexcept {
    if (!start_ns_ || state.time_ns - *start_ns_ > kWatched_ns) {
      end();
      return -1;
    }
    for (int i = 0; i < state.num_joints; ++i) {
      const Joint& joint = joints_[static_cast<std::size_t>(i)];
      if (!(std::abs(state.theta[i] - joint.start) <= joint.most)) return i;
    }
    return -1;
  }

 private:
  struct Joint {
    bool elastic;
    double least_free;
    double most_free;
    double start;  ///< from begin() on, as `most`
    double most;
  };
  std::array<Joint, kMaxJoints> joints_{};
  std::optional<std::int64_t> start_ns_;
};

}  // namespace limber::controller
