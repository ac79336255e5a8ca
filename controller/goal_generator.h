// Turns goals as users send them into a smooth motion of the goal a law follows.
#pragma once

#include <limber/compliance_goal_t.hpp>

#include "controller/goal.h"
#include "controller/interpolation.h"
#include "controller/laws/law.h"
#include "controller/smooth_motion.h"
#include "robots/robot.h"

namespace limber::controller {

/// Holds the present goal. A message is checked whole and refused or accepted whole; an accepted
/// one starts a motion (see QuinticMotion; joint goals from rest for laws that ask for it along
/// SmoothMotion) from the present goal, in position, velocity and
/// acceleration, to the new one. The motion takes the time asked for, or longer where the speed
/// would exceed the limits below; 0 asks for the default speed. All members may be called in the
/// cycle.
class GoalGenerator {
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
  static constexpr double kFarthest_m = 10.0;
  static constexpr double kMaxForce_N = 200.0;
  static constexpr double kMaxMoment_Nm = 50.0;

  explicit GoalGenerator(const Robot& robot);

  static constexpr double kShortestPeriod_s = 0.2;

  /// The goal is where the arm is, at rest; no feed-forward; posture as it is.
  void reset(const Pose& X_BT, const VectorJ& q) noexcept;

  /// nullptr if a law of this kind may follow the goal, else why not.
  const char* refuse(const compliance_goal_t& message, Follows follows) const noexcept;
  /// nullptr: accepted, else why not. GOAL_OFFSET counts from the end of the motion under way; a
  /// feed-forward wrench stays until the next goal, which replaces it.
  const char* set(const compliance_goal_t& message, Follows follows) noexcept;

  /// True if the goal was last set at the tip, false if at the joints.
  bool at_tip() const noexcept { return at_tip_; }
  /// The goal at the tip that goes with one set at the joints, or the other way round: where the
  /// other kind starts from.
  void follow_tip(const Pose& X_BD) noexcept;
  void follow_joints(const VectorJ& q_d) noexcept;

  /// Brings the goal to rest in `duration_s`, wherever it then is.
  void stop(double duration_s) noexcept;
  void advance(double dt_s) noexcept;

  const Goal& goal() const noexcept { return goal_; }

 private:
  const char* refuse_tip(const compliance_goal_t& message) const noexcept;
  const char* refuse_joints(const double* q) const noexcept;
  void start(const compliance_goal_t& message, Follows follows) noexcept;
  void start_joints(const VectorJ& q, double T, bool smooth) noexcept;
  Pose end_of(const compliance_goal_t& message) const noexcept;
  double pose_time(const Pose& end, double speed, double turn) const noexcept;
  double joint_time(const VectorJ& from, const VectorJ& to, double share) const noexcept;
  void copy() noexcept;

  VectorJ position_min_;
  VectorJ position_max_;
  VectorJ velocity_limit_;
  PoseMotion pose_;
  QuinticMotion<VectorJ> joints_;
  SmoothMotion<VectorJ> smooth_;  // leads joints_ while it moves
  QuinticMotion<VectorJ> posture_;
  QuinticMotion<Vector6> wrench_;
  bool at_tip_ = true;
  Goal goal_;
};

}  // namespace limber::controller
