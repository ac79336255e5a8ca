#include "controller/goals/stream/target_stream.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limber/controller_status_t.hpp>

#include "controller/model/rotation.h"

namespace limber::controller {
namespace {

constexpr double kFadeAcceleration = 2.0;           // m/s^2, rad/s^2
constexpr double kFastestAcceleration = 10.0;       // of the tip, m/s^2
constexpr double kFastestJointAcceleration = 25.0;  // rad/s^2; the tip's turn, too
constexpr std::size_t kMostKnots = 16;
constexpr float kFarthestJoint = 1e3F;
constexpr double kRounded = 1.0 + 1e-6;  // a number that was rounded to 32 bits
constexpr double kClipped = 1e-6;        // rad or m: more than float32 rounds

StreamBounds<VectorJ> joint_bounds(const Robot& robot) {
  const int n = robot.size();
  StreamBounds<VectorJ> bounds{VectorJ::Zero(n), VectorJ::Constant(n, kFadeAcceleration),
                               VectorJ::Zero(n), VectorJ::Constant(n, kFastestJointAcceleration)};
  for (int i = 0; i < n; ++i) {
    const double most = robot.joints[static_cast<std::size_t>(i)].velocity_limit;
    bounds.v_fade[i] = GoalLimits::kDefaultJointShare * most;
    bounds.v_max[i] = GoalLimits::kFastestJointShare * most;
  }
  return bounds;
}

Vector6 linear_angular(double linear, double angular) noexcept {
  Vector6 both;
  both << Eigen::Vector3d::Constant(linear), Eigen::Vector3d::Constant(angular);
  return both;
}

StreamBounds<Vector6> tip_bounds() {
  return {linear_angular(GoalLimits::kDefaultSpeed_m_per_s, GoalLimits::kDefaultTurn_rad_per_s),
          linear_angular(kFadeAcceleration, kFadeAcceleration),
          linear_angular(GoalLimits::kFastestSpeed_m_per_s, GoalLimits::kFastestTurn_rad_per_s),
          linear_angular(kFastestAcceleration, kFastestJointAcceleration)};
}

// As it was meant before it was rounded to 32 bits.
double seconds_of(float given) noexcept {
  return 1e-6 * std::round(1e6 * static_cast<double>(given));
}

int columns(const target_stream_t& message) noexcept {
  switch (message.kind) {
    case target_stream_t::KIND_JOINTS:
      return message.num_joints;
    case target_stream_t::KIND_POSE:
      return 7;
    default:
      return 6;
  }
}

Eigen::Map<const Eigen::Matrix<float, 16, 1>> row(const target_stream_t& message, int knot) {
  return Eigen::Map<const Eigen::Matrix<float, 16, 1>>(message.value[knot]);
}

Pose pose_of(const target_stream_t& message, int knot) noexcept {
  const Eigen::Matrix<double, 16, 1> x = row(message, knot).cast<double>();
  return {x.head<3>(), Eigen::Quaterniond(x[3], x[4], x[5], x[6]).normalized()};
}

Refusal check_times(const target_stream_t& message, std::int64_t now_ns) noexcept {
  if (!(message.num_knots >= 1 && message.num_knots <= static_cast<int>(kMostKnots)))
    return malformed("num_knots must be 1..16");
  if (!(message.delay_s >= 0.0F && message.delay_s <= TargetStream::kLongestDelay_s))
    return beyond_goal_limit("delay_s must be within 0..2 s");
  if (message.t0_ns < target_stream_t::NOW)
    return malformed("t0_ns must be an arm time, or NOW (-1)");
  for (int i = 0; i < message.num_knots; ++i) {
    const double dt_s = static_cast<double>(message.dt_s[i]);
    const double before_s = i == 0 ? 0.0 : static_cast<double>(message.dt_s[i - 1]);
    const double least_s = i == 0 ? 0.0 : before_s + 0.99 * TargetStream::kClosestKnots_s;
    if (!(dt_s >= least_s && dt_s <= 10.0))
      return malformed("dt_s must rise by 1 ms or more, within 0..10 s");
  }
  // Subtracting first: no time overflows.
  const std::int64_t ahead_ns =
      message.t0_ns == target_stream_t::NOW ? 0 : message.t0_ns - std::max<std::int64_t>(now_ns, 0);
  if (ahead_ns > TargetStream::kFarthest_ns ||
      TargetStream::end_ns(message, now_ns) - now_ns > TargetStream::kFarthest_ns)
    return beyond_goal_limit("knots are more than 5 s ahead: t0_ns counts arm time");
  return {};
}

Refusal check_poses(const target_stream_t& message) noexcept {
  for (int i = 0; i < message.num_knots; ++i) {
    const auto x = row(message, i);
    if (!(std::abs(x.segment<4>(3).norm() - 1.0F) <= 0.01F))
      return malformed("a quaternion is not a unit quaternion");
    if (!(x.head<3>().norm() <= GoalLimits::kFarthest_m))
      return beyond_goal_limit("a knot is more than 10 m from the base");
    if (i == 0) continue;
    const Eigen::Quaterniond turn = pose_of(message, i).Q * pose_of(message, i - 1).Q.conjugate();
    if (!(log_rotation(turn).norm() <= TargetStream::kLargestTurn_rad))
      return beyond_goal_limit("knots that follow on each other are more than 2 rad apart");
  }
  return {};
}

Refusal check_twists(const target_stream_t& message) noexcept {
  for (int i = 0; i < message.num_knots; ++i) {
    const Vector6 V = row(message, i).head<6>().cast<double>();
    if (!(V.head<3>().norm() <= kRounded * GoalLimits::kFastestSpeed_m_per_s &&
          V.tail<3>().norm() <= kRounded * GoalLimits::kFastestTurn_rad_per_s))
      return beyond_goal_limit("a twist is more than 1 m/s or 4 rad/s");
  }
  return {};
}

// Of joints without ends: those with are stopped there.
Refusal check_joints(const target_stream_t& message) noexcept {
  for (int i = 0; i < message.num_knots; ++i) {
    if (!(row(message, i).head(message.num_joints).cwiseAbs().maxCoeff() <= kFarthestJoint))
      return beyond_goal_limit("a joint is more than 1000 rad from zero: is it another unit?");
  }
  return {};
}

// From which a joint comes to rest within so far.
VectorJ braking_speed(const VectorJ& way) noexcept {
  return (2.0 * kFastestJointAcceleration * way.cwiseMax(0.0)).cwiseSqrt();
}

}  // namespace

TargetStream::TargetStream(const Robot& robot)
    : position_min_(robot.size()),
      position_max_(robot.size()),
      tip_(tip_bounds()),
      joints_(joint_bounds(robot)) {
  for (int i = 0; i < robot.size(); ++i) {
    const JointConfig& joint = robot.joints[static_cast<std::size_t>(i)];
    position_min_[i] = joint.position_min;
    position_max_[i] = joint.position_max;
  }
}

Refusal TargetStream::check(const target_stream_t& message, GoalType type,
                            std::int64_t now_ns) const noexcept {
  if (message.num_joints != position_min_.size()) return malformed("num_joints is not this arm's");
  if (message.kind < target_stream_t::KIND_JOINTS || message.kind > target_stream_t::KIND_TWIST)
    return malformed("kind is none of KIND_JOINTS, KIND_POSE, KIND_TWIST");
  if (const Refusal refusal = check_times(message, now_ns)) return refusal;
  for (int i = 0; i < message.num_knots; ++i) {
    if (!row(message, i).head(columns(message)).allFinite())
      return malformed("a knot is not finite");
    if (message.use_hand != 0 && !std::isfinite(message.hand_width_m[i]))
      return malformed("hand_width_m is not finite");
  }
  if (!(message.hand_force_N >= 0.0F && std::isfinite(message.hand_force_N)))
    return malformed("hand_force_N must be 0 or more");
  if (const float scale = message.stiffness_scale;
      scale != 0.0F && !(scale >= static_cast<float>(kSoftest) && scale <= 1.0F))
    return beyond_goal_limit("stiffness_scale must be 0, or within 0.05..1");
  const Vector6 F = Eigen::Map<const Eigen::Matrix<float, 6, 1>>(message.F_ff).cast<double>();
  if (const Refusal refusal = GoalLimits::check_common(seconds_of(message.valid_for_s), F, type))
    return refusal;
  switch (message.kind) {
    case target_stream_t::KIND_POSE:
      return check_poses(message);
    case target_stream_t::KIND_TWIST:
      return check_twists(message);
    default:
      return check_joints(message);
  }
}

std::int64_t TargetStream::knot_ns(const target_stream_t& message, int knot,
                                   std::int64_t now_ns) noexcept {
  const std::int64_t t0_ns = message.t0_ns == target_stream_t::NOW ? now_ns : message.t0_ns;
  const double after_s = static_cast<double>(message.dt_s[knot]) + message.delay_s;
  return t0_ns + std::llround(1e9 * after_s);
}

std::int64_t TargetStream::end_ns(const target_stream_t& message, std::int64_t now_ns) noexcept {
  return knot_ns(message, message.num_knots - 1, now_ns);
}

VectorJ TargetStream::joints_of(const target_stream_t& message, int knot) const noexcept {
  const VectorJ q = row(message, knot).head(position_min_.size()).cast<double>();
  return q.cwiseMax(position_min_).cwiseMin(position_max_);
}

Refusal TargetStream::take(const target_stream_t& message, const Pose* poses, const Tip& tip,
                           const Joints& joints, std::int64_t now_ns) noexcept {
  const bool of_joints = message.kind == target_stream_t::KIND_JOINTS;
  const bool of_tip = !of_joints || poses != nullptr;
  if (!of_joints || !leads_joints()) joints_.reset(joints, cycle_ns_);
  if (!of_tip || !leads_tip()) tip_.reset(tip, cycle_ns_);
  clipped_ = false;
  bool taken = !of_joints || take_joints(message, now_ns);
  if (message.kind == target_stream_t::KIND_TWIST) {
    taken = take_twist(message, now_ns);
  } else if (of_tip) {
    taken = taken && take_tip(message, poses, now_ns);
  }
  if (!taken) return beyond_goal_limit("more than 256 knots wait: send fewer, or less far ahead");
  last_ns_ = end_ns(message, now_ns);
  starved_ = false;
  delay_s_ = static_cast<double>(message.delay_s);
  ++counts_.taken;
  if (last_ns_ < now_ns) ++counts_.late;
  return {};
}

bool TargetStream::take_joints(const target_stream_t& message, std::int64_t now_ns) noexcept {
  std::array<Knot<JointSpace>, kMostKnots> knots;
  for (int i = 0; i < message.num_knots; ++i) {
    const VectorJ q = joints_of(message, i);
    const VectorJ wanted = row(message, i).head(q.size()).cast<double>();
    clipped_ = clipped_ || !(q - wanted).isZero(kClipped);
    knots[static_cast<std::size_t>(i)] = {knot_ns(message, i, now_ns), q};
  }
  return joints_.take(std::span(knots).first(static_cast<std::size_t>(message.num_knots)));
}

bool TargetStream::take_tip(const target_stream_t& message, const Pose* poses,
                            std::int64_t now_ns) noexcept {
  std::array<Knot<TipSpace>, kMostKnots> knots;
  for (int i = 0; i < message.num_knots; ++i) {
    knots[static_cast<std::size_t>(i)] = {knot_ns(message, i, now_ns),
                                          poses != nullptr ? poses[i] : pose_of(message, i)};
  }
  return tip_.take(std::span(knots).first(static_cast<std::size_t>(message.num_knots)));
}

// From where the curve is at the first knot on, along the mean twist between two knots.
bool TargetStream::take_twist(const target_stream_t& message, std::int64_t now_ns) noexcept {
  std::array<Knot<TipSpace>, kMostKnots + 1> knots;
  const int n = message.num_knots;
  Knot<TipSpace> knot{knot_ns(message, 0, now_ns), {}};
  knot.x = tip_.path_at(std::max(knot.time_ns, cycle_ns_)).x;
  Vector6 V = row(message, 0).head<6>().cast<double>();
  for (int i = 0; i < n; ++i) {
    knots[static_cast<std::size_t>(i)] = knot;
    const bool last = i + 1 == n;
    const Vector6 next = row(message, last ? i : i + 1).head<6>().cast<double>();
    const std::int64_t then_ns =
        last ? knot.time_ns + std::llround(1e9 * kTwistLasts_s) : knot_ns(message, i + 1, now_ns);
    const double dt_s = 1e-9 * static_cast<double>(then_ns - knot.time_ns);
    const Rates<Vector6> way{0.5 * dt_s * (V + next), Vector6::Zero(), Vector6::Zero()};
    knot = {then_ns, TipSpace::compose(way, TipSpace::at_rest(knot.x)).x};
    V = next;
  }
  knots[static_cast<std::size_t>(n)] = knot;
  return tip_.take(std::span(knots).first(static_cast<std::size_t>(n + 1)));
}

void TargetStream::advance(std::int64_t now_ns, double dt_s) noexcept {
  cycle_ns_ = now_ns;
  if (!leads_tip() && !leads_joints()) return;
  if (leads_tip()) tip_.advance(now_ns, dt_s, tip_.bounds().v_max, tip_.bounds().v_max);
  if (leads_joints()) {
    const VectorJ& q = joints_.goal().x;
    joints_.advance(now_ns, dt_s, braking_speed(position_max_ - q),
                    braking_speed(q - position_min_));
  }
  margin_s_ = 1e-9 * static_cast<double>(last_ns_ - now_ns);
  if (!starved_ && last_ns_ + kStarved_ns < now_ns) {
    starved_ = true;
    ++counts_.starved;
  }
}

void TargetStream::end() noexcept {
  tip_.reset(tip_.goal(), cycle_ns_);
  joints_.reset(joints_.goal(), cycle_ns_);
  clipped_ = starved_ = false;
}

std::int8_t TargetStream::state() const noexcept {
  if (!leads_tip() && !leads_joints()) return controller_status_t::STREAM_NONE;
  return starved_ ? controller_status_t::STREAM_WAITING : controller_status_t::STREAM_RUNNING;
}

}  // namespace limber::controller
