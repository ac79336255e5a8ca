#include "controller/goals/stream/stream_space.h"

#include "controller/model/rotation.h"

namespace limber::controller {

JointSpace::Point JointSpace::at_rest(const Value& x) noexcept { return {x, 0.0 * x, 0.0 * x}; }

Rates<VectorJ> JointSpace::relative(const Point& point, const Point& from) noexcept {
  return {point.x - from.x, point.v - from.v, point.a - from.a};
}

JointSpace::Point JointSpace::compose(const Rates<VectorJ>& motion, const Point& from) noexcept {
  return {from.x + motion.x, from.v + motion.v, from.a + motion.a};
}

TipSpace::Point TipSpace::at_rest(const Value& x) noexcept {
  return {x, Vector6::Zero(), Vector6::Zero()};
}

Rates<Vector6> TipSpace::relative(const Point& point, const Point& from) noexcept {
  Rates<Vector6> motion;
  const Eigen::Quaterniond turn = point.x.Q * from.x.Q.conjugate();
  const Eigen::Vector3d r = log_rotation(turn);
  const Eigen::Vector3d carried = turn * Eigen::Vector3d(from.v.tail<3>());
  const Eigen::Vector3d omega = point.v.tail<3>() - carried;
  const Eigen::Vector3d alpha =
      point.a.tail<3>() - turn * Eigen::Vector3d(from.a.tail<3>()) - omega.cross(carried);
  const Eigen::Matrix3d inverse = left_jacobian_inverse(r);
  const Eigen::Vector3d rate = inverse * omega;
  motion.x << point.x.p - from.x.p, r;
  motion.v << point.v.head<3>() - from.v.head<3>(), rate;
  motion.a << point.a.head<3>() - from.a.head<3>(),
      inverse * (alpha - left_jacobian_rate(r, rate) * rate);
  return motion;
}

TipSpace::Point TipSpace::compose(const Rates<Vector6>& motion, const Point& from) noexcept {
  const Eigen::Vector3d r = motion.x.tail<3>();
  const Eigen::Vector3d rate = motion.v.tail<3>();
  const Eigen::Quaterniond turn = exp_rotation(r);
  const Eigen::Matrix3d jacobian = left_jacobian(r);
  const Eigen::Vector3d omega = jacobian * rate;
  const Eigen::Vector3d carried = turn * Eigen::Vector3d(from.v.tail<3>());
  Point point;
  point.x = {from.x.p + motion.x.head<3>(), (turn * from.x.Q).normalized()};
  point.v << from.v.head<3>() + motion.v.head<3>(), omega + carried;
  point.a << from.a.head<3>() + motion.a.head<3>(),
      jacobian * motion.a.tail<3>() + left_jacobian_rate(r, rate) * rate +
          turn * Eigen::Vector3d(from.a.tail<3>()) + omega.cross(carried);
  return point;
}

}  // namespace limber::controller
