#include "controller/goals/goal_generator.h"

#include <algorithm>

#include "controller/model/rotation.h"

namespace limber::controller {
namespace {

// Peak speed of SmoothMotion over that of the minimum-jerk motion, for the same time.
constexpr double kSmoothPeak = SmoothMotion<VectorJ>::kPeak / 1.875;

Vector6 six(const double (&values)[6]) noexcept { return Eigen::Map<const Vector6>(values); }

Pose pose_of(const compliance_goal_t& message) noexcept {
  const double* q = message.quat_BD;
  return {Eigen::Map<const Eigen::Vector3d>(message.p_BD),
          Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized()};
}

}  // namespace

GoalGenerator::GoalGenerator(const Robot& robot)
    : limits_(robot),
      joints_(VectorJ::Zero(robot.size())),
      smooth_(joints_.x),
      posture_(VectorJ::Zero(robot.size())),
      wrench_(Vector6::Zero()),
      stream_(robot),
      goal_(robot.size()) {}

void GoalGenerator::reset(const Pose& X_BT, const VectorJ& q) noexcept {
  pose_.reset(X_BT);
  joints_.reset(q);
  smooth_ = SmoothMotion<VectorJ>(q);
  posture_.reset(q);
  wrench_.reset(Vector6::Zero());
  stream_.end();
  copy();
}

Refusal GoalGenerator::set(const compliance_goal_t& message, GoalType type) noexcept {
  if (const Refusal refusal = check(message, type)) return refusal;
  stream_.end();
  const bool limited = message.duration_s > 0.0;
  const double T = std::max(message.duration_s, GoalLimits::kShortestMotion_s);
  switch (message.kind) {
    case compliance_goal_t::GOAL_JOINT:
      start_joints(message, type == GoalType::kSmoothJoints, T, limited);
      break;
    case compliance_goal_t::GOAL_CIRCLE:
      start_circle(message);
      break;
    default:
      start_tip(message, T, limited);
  }
  return {};
}

Refusal GoalGenerator::set_stream(const target_stream_t& message, const Pose* poses, bool at_tip,
                                  std::int64_t now_ns) noexcept {
  const QuinticMotion<VectorJ>& joints = at_tip ? posture_ : joints_;
  const Refusal refusal = stream_.take(message, poses, {pose_.X_BD, pose_.V_BD, pose_.A_BD},
                                       {joints.x, joints.v, joints.a}, now_ns);
  if (refusal) return refusal;
  at_tip_ = at_tip;
  smooth_.end();
  const Vector6 F = Eigen::Map<const Eigen::Matrix<float, 6, 1>>(message.F_ff).cast<double>();
  if (F != wrench_.end()) wrench_.start(F, GoalLimits::kShortestMotion_s);
  return refusal;
}

// A motion under way goes on along the quintic, which takes it as it is.
void GoalGenerator::start_joints(const compliance_goal_t& message, bool smooth, double T,
                                 bool limited) noexcept {
  at_tip_ = false;
  const VectorJ q = Eigen::Map<const Eigen::VectorXd>(message.q, goal_.q_d.size());
  T = std::max(T, (smooth ? kSmoothPeak : 1.0) * limits_.joint_time(joints_.x, q, limited));
  if (smooth && !joints_.moving() && !smooth_.moving()) {
    smooth_.start(joints_.x, q, T);
  } else {
    smooth_.end();
    joints_.start(q, T);
  }
  wrench_.start(six(message.F_ff), T);
}

void GoalGenerator::start_circle(const compliance_goal_t& message) noexcept {
  at_tip_ = true;
  const Vector6 offset = six(message.offset);
  pose_.circle(pose_.X_BD.p + offset.head<3>(), offset.tail<3>().normalized(), message.duration_s);
  wrench_.start(six(message.F_ff), GoalLimits::kShortestMotion_s);
}

void GoalGenerator::start_tip(const compliance_goal_t& message, double T, bool limited) noexcept {
  const bool moves = message.kind != compliance_goal_t::GOAL_WRENCH;
  const Pose end = end_of(message);
  if (moves) T = std::max(T, limits_.pose_time(pose_.X_BD, end, limited));
  if (message.use_posture != 0) {
    const VectorJ q = Eigen::Map<const Eigen::VectorXd>(message.q, goal_.q_d.size());
    T = std::max(T, limits_.joint_time(posture_.x, q, limited));
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

void GoalGenerator::follow_tip(const Pose& X_BD) noexcept {
  stream_.end();
  pose_.reset(X_BD);
  copy();
}

void GoalGenerator::follow_joints(const VectorJ& q_d) noexcept {
  stream_.end();
  joints_.reset(q_d);
  smooth_ = SmoothMotion<VectorJ>(q_d);
  copy();
}

void GoalGenerator::stop(double duration_s) noexcept {
  stream_.end();
  pose_.stop(duration_s);
  smooth_.end();
  joints_.stop(duration_s);
  posture_.stop(duration_s);
  wrench_.stop(duration_s);
}

void GoalGenerator::advance(double dt_s, std::int64_t now_ns) noexcept {
  pose_.advance(dt_s);
  joints_.advance(dt_s);
  if (smooth_.moving()) {
    smooth_.advance(dt_s);
    joints_.follow(smooth_.x, smooth_.v, smooth_.a);
  }
  posture_.advance(dt_s);
  wrench_.advance(dt_s);
  stream_.advance(now_ns, dt_s);
  follow_stream();
  copy();
}

void GoalGenerator::follow_stream() noexcept {
  if (stream_.leads_tip()) pose_.follow(stream_.tip().x, stream_.tip().v, stream_.tip().a);
  if (!stream_.leads_joints()) return;
  QuinticMotion<VectorJ>& led = at_tip_ ? posture_ : joints_;
  led.follow(stream_.joints().x, stream_.joints().v, stream_.joints().a);
}

void GoalGenerator::copy() noexcept {
  goal_.X_BD = pose_.X_BD;
  goal_.V_BD = pose_.V_BD;
  goal_.A_BD = pose_.A_BD;
  goal_.F_ff = wrench_.x;
  goal_.q_d = joints_.x;
  goal_.v_d = joints_.v;
  goal_.a_d = joints_.a;
  goal_.smooth = smooth_.moving() ? &smooth_ : nullptr;
  goal_.q_null = posture_.x;
}

}  // namespace limber::controller
