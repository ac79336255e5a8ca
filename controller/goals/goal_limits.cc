#include "controller/goals/goal_limits.h"

#include <algorithm>
#include <cmath>

#include "controller/model/rotation.h"

namespace limber::controller {
namespace {

// Peak speed of the minimum-jerk motion, times duration, over distance.
constexpr double kPeak = 1.875;

bool finite(const double* values, int count) noexcept {
  return std::all_of(values, values + count, [](double x) { return std::isfinite(x); });
}

Vector6 six_of(const double (&values)[6]) noexcept { return Eigen::Map<const Vector6>(values); }

Refusal within_reach(const Eigen::Vector3d& p) noexcept {
  if (!(p.norm() <= GoalLimits::kFarthest_m))
    return beyond_goal_limit("the goal is more than 10 m from the base");
  return {};
}

Refusal check_pose(const compliance_goal_t& message) noexcept {
  if (!finite(message.p_BD, 3) || !finite(message.quat_BD, 4)) {
    return malformed("the pose is not finite");
  }
  const double norm = Eigen::Map<const Eigen::Vector4d>(message.quat_BD).norm();
  if (!(std::abs(norm - 1.0) <= 0.01)) {
    return malformed("quat_BD is not a unit quaternion");
  }
  return {};
}

}  // namespace

GoalLimits::GoalLimits(const Robot& robot)
    : position_min_(robot.size()), position_max_(robot.size()), velocity_limit_(robot.size()) {
  for (int i = 0; i < robot.size(); ++i) {
    const JointConfig& joint = robot.joints[static_cast<std::size_t>(i)];
    position_min_[i] = joint.position_min;
    position_max_[i] = joint.position_max;
    velocity_limit_[i] = joint.velocity_limit;
  }
}

Refusal GoalLimits::check(const compliance_goal_t& message, GoalType type, const Pose& end,
                          bool moving) const noexcept {
  if (message.num_joints != position_min_.size()) return malformed("num_joints is not this arm's");
  if (!(message.duration_s >= 0.0 && message.duration_s <= kLongestMotion_s)) {
    return beyond_goal_limit("duration_s must be within 0..600 s");
  }
  if (const Refusal refusal = check_common(message.valid_for_s, six_of(message.F_ff), type))
    return refusal;
  if (message.kind == compliance_goal_t::GOAL_JOINT) {
    if (type == GoalType::kPose)
      return {request_answer_t::REFUSED_GOAL_KIND, "the law follows pose goals, not joint goals"};
    return check_joints(message.q);
  }
  if (message.use_posture != 0) {
    if (const Refusal refusal = check_joints(message.q)) return refusal;
  }
  return check_tip(message, end, moving);
}

Refusal GoalLimits::check_common(double valid_s, const Vector6& F, GoalType type) noexcept {
  if (valid_s != 0.0 && !(valid_s >= kShortestValidity_s && valid_s <= kLongestMotion_s))
    return beyond_goal_limit("valid_for_s must be 0, or within 0.01..600 s");
  if (type == GoalType::kNone)
    return {request_answer_t::REFUSED_GOAL_KIND, "the law follows no goal"};
  if (!(F.head<3>().norm() <= kMaxForce_N && F.tail<3>().norm() <= kMaxMoment_Nm)) {
    return beyond_goal_limit("F_ff must be within 200 N and 50 N m");
  }
  const bool no_wrench = type == GoalType::kJoints || type == GoalType::kSmoothJoints;
  if (no_wrench && !F.isZero(0.0)) {
    return {request_answer_t::REFUSED_GOAL_KIND, "the law exerts no feed-forward wrench"};
  }
  return {};
}

Refusal GoalLimits::check_tip(const compliance_goal_t& message, const Pose& end,
                              bool moving) const noexcept {
  const Vector6 offset = six_of(message.offset);
  switch (message.kind) {
    case compliance_goal_t::GOAL_POSE:
      if (const Refusal refusal = check_pose(message)) return refusal;
      return within_reach(Eigen::Map<const Eigen::Vector3d>(message.p_BD));
    case compliance_goal_t::GOAL_OFFSET:
      if (!(offset.tail<3>().norm() <= EIGEN_PI))
        return beyond_goal_limit("the offset turns by more than pi");
      return within_reach(end.p + offset.head<3>());
    case compliance_goal_t::GOAL_CIRCLE: {
      if (moving)
        return {request_answer_t::REFUSED_GOAL_MOVING, "a circle starts from a goal at rest"};
      if (!(message.duration_s >= kShortestPeriod_s))
        return beyond_goal_limit("the period must be at least 0.2 s");
      const double radius = offset.head<3>().norm();
      if (!(radius > 0.0 && offset.tail<3>().norm() > 1e-6))
        return malformed("the circle has no centre or axis");
      if (!(2.0 * EIGEN_PI * radius <= kFastestSpeed_m_per_s * message.duration_s))
        return beyond_goal_limit("the circle is faster than 1 m/s");
      return {};
    }
    case compliance_goal_t::GOAL_WRENCH:
      return {};
    default:
      return malformed(
          "kind is none of GOAL_POSE, GOAL_JOINT, GOAL_OFFSET, GOAL_WRENCH, GOAL_CIRCLE");
  }
}

Refusal GoalLimits::check_joints(const double* q) const noexcept {
  for (Eigen::Index i = 0; i < position_min_.size(); ++i) {
    if (!(std::isfinite(q[i]) && q[i] >= position_min_[i] && q[i] <= position_max_[i])) {
      return beyond_goal_limit("q is outside the joint limits");
    }
  }
  return {};
}

double GoalLimits::pose_time(const Pose& from, const Pose& to, bool limited) const noexcept {
  const double speed = limited ? kFastestSpeed_m_per_s : kDefaultSpeed_m_per_s;
  const double turn = limited ? kFastestTurn_rad_per_s : kDefaultTurn_rad_per_s;
  const double distance = (to.p - from.p).norm();
  const double angle = log_rotation(to.Q * from.Q.conjugate()).norm();
  return kPeak * std::max(distance / speed, angle / turn);
}

double GoalLimits::joint_time(const VectorJ& from, const VectorJ& to, bool limited) const noexcept {
  const double share = limited ? kFastestJointShare : kDefaultJointShare;
  return kPeak * ((to - from).cwiseAbs().cwiseQuotient(share * velocity_limit_)).maxCoeff();
}

}  // namespace limber::controller
