// The goal of each cycle, for laws at the tip and at the joints.
#pragma once

#include "controller/goals/arm_reach.h"
#include "controller/goals/goal_generator.h"
#include "controller/goals/inverse_kinematics.h"

namespace limber::controller {

/// Moves the goal along and gives a law for the joints both: the goal at the tip and the joints
/// that go with it, by inverse kinematics one way and by the model the other. All members may be
/// called in the cycle.
class GoalTracker {
 public:
  /// The model must outlive this; its terms are not touched. `simulated`: every bus is; then goals
  /// beyond the arm's reach are taken with a warning, else refused.
  GoalTracker(const LoadedRobot& robot, ArmModel* model, bool simulated);

  /// The goal of this cycle: tip and joints matched.
  const Goal& goal() const noexcept { return goal_; }
  /// `now_ns`: arm time, `dt_s` after that of the last cycle.
  const Goal& advance(double dt_s, std::int64_t now_ns, double period_s, GoalType type,
                      const TaskRows& rows) noexcept;
  /// The goal where it is, matched for a law that follows another type.
  void match(double period_s, GoalType type, const TaskRows& rows) noexcept;

  /// The goal is where the arm is, at rest.
  void reset(const Pose& X_BT, const VectorJ& q) noexcept;
  /// A law of another type goes on with the goal there is; q: where the arm is.
  void hand_over(GoalType from, GoalType to, const TaskRows& rows, const VectorJ& q) noexcept;
  /// Brings the goal to rest in `duration_s`, wherever it then is.
  void stop(double duration_s) noexcept { generator_.stop(duration_s); }

  struct Set {
    Refusal refusal;        ///< nothing: accepted, perhaps with a warning
    bool switched = false;  ///< from the tip to the joints or back: the torque has to be blended
  };
  Set set(const compliance_goal_t& message, GoalType type) noexcept;
  /// A law for the tip follows joints with the tip's pose there, and takes them as its posture.
  Set set_stream(const target_stream_t& message, GoalType type, std::int64_t now_ns) noexcept;
  TargetStream& stream() noexcept { return generator_.stream(); }

 private:
  Refusal check_reach(const compliance_goal_t& message) noexcept;
  Refusal check_reach(const target_stream_t& message) noexcept;
  /// True if a law for the joints followed the other kind of goal before.
  bool change_kind(bool to_tip, GoalType type) noexcept;

  ArmModel* model_;
  GoalGenerator generator_;
  InverseKinematics inverse_kinematics_;
  ArmReach reach_;
  bool simulated_;
  Goal goal_;
};

}  // namespace limber::controller
