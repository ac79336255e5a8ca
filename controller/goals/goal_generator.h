// Turns goals as users send them into a smooth motion of the goal a law follows.
#pragma once

#include <limber/compliance_goal_t.hpp>

#include "controller/goals/goal_limits.h"
#include "controller/goals/interpolation.h"
#include "controller/goals/stream/target_stream.h"
#include "controller/kinds/goal.h"
#include "controller/kinds/smooth_motion.h"

namespace limber::controller {

/// Holds the present goal. A message is checked whole and refused or accepted whole; an accepted
/// one starts a motion (see QuinticMotion; joint goals from rest along SmoothMotion for laws
/// of that goal type) from the present goal, in position, velocity and
/// acceleration, to the new one. The motion takes the time given, or longer where the speed
/// would exceed GoalLimits; 0 stands for the default speed. All members may be called in the
/// cycle.
class GoalGenerator {
 public:
  explicit GoalGenerator(const Robot& robot);

  /// The goal is where the arm is, at rest; no feed-forward; posture as it is.
  void reset(const Pose& X_BT, const VectorJ& q) noexcept;

  /// Nothing if a law of this kind may follow the goal, else why not.
  Refusal check(const compliance_goal_t& message, GoalType type) const noexcept {
    return limits_.check(message, type, pose_.end(), pose_.moving() || stream_.leads_tip());
  }
  /// Nothing: accepted, else why not. GOAL_OFFSET counts from the end of the motion under way; a
  /// feed-forward wrench stays until the next goal, which replaces it.
  Refusal set(const compliance_goal_t& message, GoalType type) noexcept;

  /// A checked message of a target stream, which leads the goal from now on, until another goal or
  /// stop(); as TargetStream::take().
  Refusal set_stream(const target_stream_t& message, const Pose* poses, bool at_tip,
                     std::int64_t now_ns) noexcept;
  TargetStream& stream() noexcept { return stream_; }
  const TargetStream& stream() const noexcept { return stream_; }

  /// Where a goal at the tip leads; of a circle and of a wrench alone: where the present one does.
  Pose end_of(const compliance_goal_t& message) const noexcept;

  /// True if the goal was last set at the tip, false if at the joints.
  bool at_tip() const noexcept { return at_tip_; }
  /// The goal at the tip that goes with one set at the joints, or the other way round: where the
  /// other kind starts from.
  void follow_tip(const Pose& X_BD) noexcept;
  void follow_joints(const VectorJ& q_d) noexcept;

  /// Brings the goal to rest in `duration_s`, wherever it then is.
  void stop(double duration_s) noexcept;
  /// `now_ns`: arm time of this cycle, `dt_s` after the last.
  void advance(double dt_s, std::int64_t now_ns) noexcept;

  const Goal& goal() const noexcept { return goal_; }

 private:
  void start_joints(const compliance_goal_t& message, bool smooth, double T, bool limited) noexcept;
  void start_circle(const compliance_goal_t& message) noexcept;
  void start_tip(const compliance_goal_t& message, double T, bool limited) noexcept;
  void follow_stream() noexcept;
  void copy() noexcept;

  GoalLimits limits_;
  PoseMotion pose_;
  QuinticMotion<VectorJ> joints_;
  SmoothMotion<VectorJ> smooth_;  // leads joints_ while it moves
  QuinticMotion<VectorJ> posture_;
  QuinticMotion<Vector6> wrench_;
  TargetStream stream_;  // leads the others while it is active
  bool at_tip_ = true;
  Goal goal_;
};

}  // namespace limber::controller
