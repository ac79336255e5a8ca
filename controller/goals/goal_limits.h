// What a goal may be, and how fast it may be reached.
#pragma once

#include <limber/compliance_goal_t.hpp>

#include "common/types.h"
#include "controller/kinds/law_entry.h"
#include "controller/kinds/pose.h"
#include "controller/kinds/refusal.h"
#include "robots/loader/robot.h"

namespace limber::controller {

/// Checks goal messages and gives motions the time they need. All members may be called in the
/// cycle.
class GoalLimits {
 public:
  /// Peak speed of the goal from rest: when no duration is given, and at most.
  static constexpr double kDefaultSpeed_m_per_s = 0.25;
  static constexpr double kDefaultTurn_rad_per_s = 1.0;
  static constexpr double kFastestSpeed_m_per_s = 1.0;
  static constexpr double kFastestTurn_rad_per_s = 4.0;
  /// The same for joint goals and postures, as shares of the joints' velocity limits.
  static constexpr double kDefaultJointShare = 0.1;
  static constexpr double kFastestJointShare = 0.5;
  static constexpr double kShortestMotion_s = 0.1;
  static constexpr double kLongestMotion_s = 600.0;
  static constexpr double kShortestValidity_s = 0.01;
  static constexpr double kShortestPeriod_s = 0.2;  ///< of a circle
  static constexpr double kFarthest_m = 10.0;
  static constexpr double kMaxForce_N = 200.0;
  static constexpr double kMaxMoment_Nm = 50.0;

  explicit GoalLimits(const Robot& robot);

  /// Nothing if a law that follows `type` may have the goal, else why not. `end`: where the goal's
  /// present motion ends, from which offsets count; `moving`: it is under way.
  Refusal check(const compliance_goal_t& message, GoalType type, const Pose& end,
                bool moving) const noexcept;

  /// What goals and streams share: valid_for_s, and the feed-forward wrench, N and N m.
  static Refusal check_common(double valid_for_s, const Vector6& F, GoalType type) noexcept;

  /// Least time between two poses, or two joint positions, s; `limited`: with a duration given.
  double pose_time(const Pose& from, const Pose& to, bool limited) const noexcept;
  double joint_time(const VectorJ& from, const VectorJ& to, bool limited) const noexcept;

 private:
  Refusal check_tip(const compliance_goal_t& message, const Pose& end, bool moving) const noexcept;
  Refusal check_joints(const double* q) const noexcept;

  VectorJ position_min_;
  VectorJ position_max_;
  VectorJ velocity_limit_;
};

}  // namespace limber::controller
