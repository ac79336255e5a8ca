#include "controller/goal_generator.h"

#include <algorithm>
#include <cmath>

#include "controller/rotation.h"

namespace limber::controller {
namespace {

// Peak speed of the minimum-jerk motion, times duration, over distance.
constexpr double kPeak = 1.875;

bool finite(const double* values, int count) noexcept {
  return std::all_of(values, values + count, [](double x) { return std::isfinite(x); });
}

Vector6 six(const double (&values)[6]) noexcept { return Eigen::Map<const Vector6>(values); }

Pose pose_of(const compliance_goal_t& message) noexcept {
  const double* q = message.quat_BD;
  return {Eigen::Map<const Eigen::Vector3d>(message.p_BD),
          Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized()};
}

const char* refuse_pose(const compliance_goal_t& message) noexcept {
  if (!finite(message.p_BD, 3) || !finite(message.quat_BD, 4)) return "the pose is not finite";
  const double norm = Eigen::Map<const Eigen::Vector4d>(message.quat_BD).norm();
  if (!(std::abs(norm - 1.0) <= 0.01)) return "quat_BD is not a unit quaternion";
  return nullptr;
}

}  // namespace

GoalGenerator::GoalGenerator(const Robot& robot)
    : position_min_(robot.size()),
      position_max_(robot.size()),
      velocity_limit_(robot.size()),
      joints_(VectorJ::Zero(robot.size())),
      smooth_(joints_.x),
      posture_(VectorJ::Zero(robot.size())),
      wrench_(Vector6::Zero()),
      goal_(robot.size()) {
  for (int i = 0; i < robot.size(); ++i) {
    const JointConfig& joint = robot.joints[static_cast<std::size_t>(i)];
    position_min_[i] = joint.position_min;
    position_max_[i] = joint.position_max;
    velocity_limit_[i] = joint.velocity_limit;
  }
}

void GoalGenerator::reset(const Pose& X_BT, const VectorJ& q) noexcept {
  pose_.reset(X_BT);
  joints_.reset(q);
  smooth_ = SmoothMotion<VectorJ>(q);
  posture_.reset(q);
  wrench_.reset(Vector6::Zero());
  copy();
}

const char* GoalGenerator::set(const compliance_goal_t& message, Follows follows) noexcept {
  if (const char* reason = refuse(message, follows)) return reason;
  start(message, follows);
  return nullptr;
}

const char* GoalGenerator::refuse(const compliance_goal_t& message,
                                  Follows follows) const noexcept {
  if (message.num_joints != goal_.q_d.size()) return "num_joints is not this arm's";
  if (!(message.duration_s >= 0.0 && message.duration_s <= kLongestMotion_s)) {
    return "duration_s must be within 0..600 s";
  }
  if (follows == Follows::kNothing) return "the law follows no goal";
  const Vector6 F = six(message.F_ff);
  if (!(F.head<3>().norm() <= kMaxForce_N && F.tail<3>().norm() <= kMaxMoment_Nm)) {
    return "F_ff must be within 200 N and 50 N m";
  }
  const bool no_wrench = follows == Follows::kJointGoal || follows == Follows::kSmoothJointGoal;
  if (no_wrench && !F.isZero(0.0)) {
    return "the law exerts no feed-forward wrench";
  }
  if (message.kind == compliance_goal_t::GOAL_JOINT) {
    return follows == Follows::kPoseGoal ? "the law follows pose goals, not joint goals"
                                         : refuse_joints(message.q);
  }
  if (message.use_posture != 0) {
    if (const char* reason = refuse_joints(message.q)) return reason;
  }
  return refuse_tip(message);
}

const char* GoalGenerator::refuse_tip(const compliance_goal_t& message) const noexcept {
  const Vector6 offset = six(message.offset);
  switch (message.kind) {
    case compliance_goal_t::GOAL_POSE:
      if (const char* reason = refuse_pose(message)) return reason;
      return Eigen::Map<const Eigen::Vector3d>(message.p_BD).norm() <= kFarthest_m
                 ? nullptr
                 : "the goal is more than 10 m from the base";
    case compliance_goal_t::GOAL_OFFSET:
      if (!(offset.tail<3>().norm() <= EIGEN_PI)) return "the offset turns by more than pi";
      return (pose_.end().p + offset.head<3>()).norm() <= kFarthest_m
                 ? nullptr
                 : "the goal is more than 10 m from the base";
    case compliance_goal_t::GOAL_CIRCLE: {
      if (pose_.moving()) return "a circle starts from a goal at rest";
      if (!(message.duration_s >= kShortestPeriod_s)) return "the period must be at least 0.2 s";
      const double radius = offset.head<3>().norm();
      if (!(radius > 0.0 && offset.tail<3>().norm() > 1e-6))
        return "the circle has no centre or axis";
      return 2.0 * EIGEN_PI * radius <= kFastestSpeed_m_per_s * message.duration_s
                 ? nullptr
                 : "the circle is faster than 1 m/s";
    }
    case compliance_goal_t::GOAL_WRENCH:
      return nullptr;
    default:
      return "kind is none of GOAL_POSE, GOAL_JOINT, GOAL_OFFSET, GOAL_WRENCH, GOAL_CIRCLE";
  }
}

const char* GoalGenerator::refuse_joints(const double* q) const noexcept {
  for (Eigen::Index i = 0; i < position_min_.size(); ++i) {
    if (!(std::isfinite(q[i]) && q[i] >= position_min_[i] && q[i] <= position_max_[i])) {
      return "q is outside the joint limits";
    }
  }
  return nullptr;
}

// A motion under way goes on along the quintic, which takes it as it is.
void GoalGenerator::start_joints(const VectorJ& q, double T, bool smooth) noexcept {
  if (smooth && !joints_.moving() && !smooth_.moving()) {
    smooth_.start(joints_.x, q, T);
    return;
  }
  smooth_.end();
  joints_.start(q, T);
}

void GoalGenerator::start(const compliance_goal_t& message, Follows follows) noexcept {
  const VectorJ q = Eigen::Map<const Eigen::VectorXd>(message.q, goal_.q_d.size());
  const bool as_fast_as_allowed = !(message.duration_s > 0.0);
  const double speed = as_fast_as_allowed ? kDefaultSpeed_m_per_s : kFastestSpeed_m_per_s;
  const double turn = as_fast_as_allowed ? kDefaultTurn_rad_per_s : kFastestTurn_rad_per_s;
  const double share = as_fast_as_allowed ? kDefaultJointShare : kFastestJointShare;
  double T = std::max(message.duration_s, kShortestMotion_s);

  if (message.kind == compliance_goal_t::GOAL_JOINT) {
    at_tip_ = false;
    const bool smooth = follows == Follows::kSmoothJointGoal;
    const double faster = smooth ? SmoothMotion<VectorJ>::kPeak / kPeak : 1.0;
    T = std::max(T, faster * joint_time(joints_.x, q, share));
    start_joints(q, T, smooth);
    wrench_.start(six(message.F_ff), T);
    return;
  }
  if (message.kind == compliance_goal_t::GOAL_CIRCLE) {
    at_tip_ = true;
    const Vector6 offset = six(message.offset);
    pose_.circle(pose_.X_BD.p + offset.head<3>(), offset.tail<3>().normalized(),
                 message.duration_s);
    wrench_.start(six(message.F_ff), kShortestMotion_s);
    return;
  }
  const bool moves = message.kind != compliance_goal_t::GOAL_WRENCH;
  const Pose end = end_of(message);
  if (moves) T = std::max(T, pose_time(end, speed, turn));
  if (message.use_posture != 0) {
    T = std::max(T, joint_time(posture_.x, q, share));
    posture_.start(q, T);
  }
  if (moves) {
    at_tip_ = true;
    pose_.start(end, T);
  }
  wrench_.start(six(message.F_ff), T);
}

Pose GoalGenerator::end_of(const compliance_goal_t& message) const noexcept {
  if (message.kind == compliance_goal_t::GOAL_POSE) return pose_of(message);
  Pose end = pose_.end();
  if (message.kind == compliance_goal_t::GOAL_OFFSET) {
    const Vector6 offset = six(message.offset);
    end.p += offset.head<3>();
    end.Q = exp_rotation(offset.tail<3>()) * end.Q;
  }
  return end;
}

double GoalGenerator::pose_time(const Pose& end, double speed, double turn) const noexcept {
  const double distance = (end.p - pose_.X_BD.p).norm();
  const double angle = log_rotation(end.Q * pose_.X_BD.Q.conjugate()).norm();
  return kPeak * std::max(distance / speed, angle / turn);
}

double GoalGenerator::joint_time(const VectorJ& from, const VectorJ& to,
                                 double share) const noexcept {
  return kPeak * ((to - from).cwiseAbs().cwiseQuotient(share * velocity_limit_)).maxCoeff();
}

void GoalGenerator::follow_tip(const Pose& X_BD) noexcept {
  pose_.reset(X_BD);
  copy();
}

void GoalGenerator::follow_joints(const VectorJ& q_d) noexcept {
  joints_.reset(q_d);
  smooth_ = SmoothMotion<VectorJ>(q_d);
  copy();
}

void GoalGenerator::stop(double duration_s) noexcept {
  pose_.stop(duration_s);
  smooth_.end();
  joints_.stop(duration_s);
  posture_.stop(duration_s);
  wrench_.stop(duration_s);
}

void GoalGenerator::advance(double dt_s) noexcept {
  pose_.advance(dt_s);
  joints_.advance(dt_s);
  if (smooth_.moving()) {
    smooth_.advance(dt_s);
    joints_.reset(smooth_.x);
    joints_.v = smooth_.v;
    joints_.a = smooth_.a;
  }
  posture_.advance(dt_s);
  wrench_.advance(dt_s);
  copy();
}

void GoalGenerator::copy() noexcept {
  goal_.X_BD = pose_.X_BD;
  goal_.V_BD = pose_.V_BD;
  goal_.A_BD = pose_.A_BD;
  goal_.F_ff = wrench_.x;
  goal_.q_d = joints_.x;
  goal_.v_d = joints_.v;
  goal_.a_d = joints_.a;
  goal_.j_d = smooth_.moving() ? smooth_.jerk : VectorJ(0.0 * joints_.x);
  goal_.s_d = smooth_.moving() ? smooth_.snap : VectorJ(0.0 * joints_.x);
  goal_.q_null = posture_.x;
}

}  // namespace limber::controller
