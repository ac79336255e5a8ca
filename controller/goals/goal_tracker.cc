#include "controller/goals/goal_tracker.h"

#include <array>

#include "robots/loader/load_robot.h"

namespace limber::controller {

GoalTracker::GoalTracker(const LoadedRobot& robot, ArmModel* model, bool simulated)
    : model_(model),
      generator_(robot.robot),
      inverse_kinematics_(*model),
      reach_(robot),
      simulated_(simulated),
      goal_(robot.robot.size()) {}

const Goal& GoalTracker::advance(double dt_s, std::int64_t now_ns, double period_s, GoalType type,
                                 const TaskRows& rows) noexcept {
  generator_.advance(dt_s, now_ns);
  match(period_s, type, rows);
  return goal_;
}

void GoalTracker::match(double period_s, GoalType type, const TaskRows& rows) noexcept {
  goal_ = generator_.goal();
  if (!follows_joints(type)) return;
  if (generator_.at_tip()) {
    inverse_kinematics_.track(rows, period_s, &goal_);
  } else {
    const auto [X_BD, J] = model_->tip(goal_.q_d);
    goal_.X_BD = X_BD;
    goal_.V_BD = J * goal_.v_d;
  }
}

void GoalTracker::reset(const Pose& X_BT, const VectorJ& q) noexcept {
  generator_.reset(X_BT, q);
  inverse_kinematics_.reset(q);
  goal_ = generator_.goal();
}

void GoalTracker::hand_over(GoalType from, GoalType to, const TaskRows& rows,
                            const VectorJ& q) noexcept {
  if (follows_joints(from) == follows_joints(to)) return;
  if (follows_joints(to)) {
    // A goal at the tip, followed by the joints from now on.
    inverse_kinematics_.reset(q);
    inverse_kinematics_.approach(rows, generator_.goal().X_BD);
  } else if (!generator_.at_tip()) {
    // A motion of the joints ends here for both, or a law for the joints would find its end later.
    generator_.follow_joints(goal_.q_d);
    generator_.follow_tip(goal_.X_BD);
  }
}

GoalTracker::Set GoalTracker::set(const compliance_goal_t& message, GoalType type) noexcept {
  if (const Refusal refusal = generator_.check(message, type)) return {refusal};
  const Refusal far = check_reach(message);
  if (far && !simulated_) return {far};
  const bool wrench_alone = message.kind == compliance_goal_t::GOAL_WRENCH;
  const bool to_tip =
      wrench_alone ? generator_.at_tip() : message.kind != compliance_goal_t::GOAL_JOINT;
  const bool switched = change_kind(to_tip, type);
  Refusal taken = generator_.set(message, type);
  taken.warning = far.reason;
  return {taken, switched};
}

// The other kind of goal starts from where this one is.
bool GoalTracker::change_kind(bool to_tip, GoalType type) noexcept {
  if (!follows_joints(type) || to_tip == generator_.at_tip()) return false;
  if (to_tip) {
    generator_.follow_tip(goal_.X_BD);
    inverse_kinematics_.reset(goal_.q_d);
  } else {
    generator_.follow_joints(goal_.q_d);
  }
  return true;
}

GoalTracker::Set GoalTracker::set_stream(const target_stream_t& message, GoalType type,
                                         std::int64_t now_ns) noexcept {
  if (const Refusal refusal = generator_.stream().check(message, type, now_ns)) return {refusal};
  if (TargetStream::stale(message, now_ns)) {
    generator_.stream().count_stale();
    return {};
  }
  const Refusal far = check_reach(message);
  if (far && !simulated_) return {far};
  const bool of_joints = message.kind == target_stream_t::KIND_JOINTS;
  const bool to_tip = !of_joints || !follows_joints(type);
  std::array<Pose, 16> poses;
  if (of_joints && to_tip) {
    for (int i = 0; i < message.num_knots; ++i) {
      poses[static_cast<std::size_t>(i)] =
          model_->tip(generator_.stream().joints_of(message, i)).X_BT;
    }
  }
  const bool switched = change_kind(to_tip, type);
  Refusal taken =
      generator_.set_stream(message, of_joints && to_tip ? poses.data() : nullptr, to_tip, now_ns);
  taken.warning = far.reason;
  return {taken, switched};
}

Refusal GoalTracker::check_reach(const target_stream_t& message) noexcept {
  if (message.kind != target_stream_t::KIND_POSE) return {};
  for (int i = 0; i < message.num_knots; ++i) {
    const float* p = message.value[i];
    if (const Refusal far = reach_.check(Eigen::Vector3f(p[0], p[1], p[2]).cast<double>()))
      return far;
  }
  return {};
}

Refusal GoalTracker::check_reach(const compliance_goal_t& message) noexcept {
  const Pose end = generator_.end_of(message);
  switch (message.kind) {
    case compliance_goal_t::GOAL_POSE:
    case compliance_goal_t::GOAL_OFFSET:
      return reach_.check(end.p);
    case compliance_goal_t::GOAL_CIRCLE: {
      const Eigen::Vector3d centre(message.offset[0], message.offset[1], message.offset[2]);
      const Eigen::Vector3d axis(message.offset[3], message.offset[4], message.offset[5]);
      return reach_.check_circle(end.p + centre, axis, centre.norm());
    }
    default:
      return {};
  }
}

}  // namespace limber::controller
