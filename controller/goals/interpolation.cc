#include "controller/goals/interpolation.h"

#include <numbers>

#include "controller/model/rotation.h"

namespace limber::controller {

CircleMotion::CircleMotion(const Eigen::Vector3d& start, const Eigen::Vector3d& centre_at,
                           const Eigen::Vector3d& about, double period) noexcept
    : axis(about), period_s(period) {
  const Eigen::Vector3d arm = start - centre_at;
  radius = arm - axis * axis.dot(arm);
  centre = start - radius;
}

void CircleMotion::at(double t, Eigen::Vector3d* x, Eigen::Vector3d* v,
                      Eigen::Vector3d* a) const noexcept {
  const double omega = 2.0 * std::numbers::pi / period_s;
  const double s = t / period_s;
  double angle = omega * (t - 0.5 * period_s);
  double rate = omega;
  double rate_rate = 0.0;
  if (s < 1.0) {
    const double s2 = s * s;
    angle = omega * period_s * s2 * s2 * (2.5 - 3.0 * s + s2);
    rate = omega * s2 * s * (10.0 - 15.0 * s + 6.0 * s2);
    rate_rate = omega / period_s * 30.0 * s2 * (1.0 - 2.0 * s + s2);
  }
  const Eigen::Vector3d r = exp_rotation(angle * axis) * radius;
  *x = centre + r;
  *v = rate * axis.cross(r);
  *a = rate_rate * axis.cross(r) - rate * rate * r;
}

PoseMotion::PoseMotion()
    : position_(Eigen::Vector3d::Zero()),
      rotation_(Eigen::Vector3d::Zero()),
      base_(Eigen::Quaterniond::Identity()),
      circle_(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ(), 1.0) {}

void PoseMotion::reset(const Pose& rest) noexcept {
  circling_ = false;
  position_.reset(rest.p);
  rotation_.reset(Eigen::Vector3d::Zero());
  base_ = rest.Q.normalized();
  update();
}

void PoseMotion::start(const Pose& end, double T) noexcept {
  circling_ = false;
  // The same motion, written as a rotation vector from the new end: J_l r' = omega and its rate.
  base_ = end.Q.normalized();
  rotation_.x = log_rotation(X_BD.Q * base_.conjugate());
  const Eigen::Matrix3d inverse = left_jacobian_inverse(rotation_.x);
  rotation_.v = inverse * V_BD.tail<3>();
  rotation_.a =
      inverse * (A_BD.tail<3>() - left_jacobian_rate(rotation_.x, rotation_.v) * rotation_.v);
  rotation_.start(Eigen::Vector3d::Zero(), T);
  position_.start(end.p, T);
}

void PoseMotion::circle(const Eigen::Vector3d& centre, const Eigen::Vector3d& axis,
                        double period_s) noexcept {
  circle_ = CircleMotion(position_.x, centre, axis, period_s);
  circling_ = true;
  circling_s_ = 0.0;
}

void PoseMotion::stop(double T) noexcept {
  circling_ = false;
  position_.stop(T);
  rotation_.stop(T);
}

// About the present orientation J_l is the identity, and its rate along omega turns nothing.
void PoseMotion::follow(const Pose& X, const Vector6& V, const Vector6& A) noexcept {
  reset(X);
  position_.follow(X.p, V.head<3>(), A.head<3>());
  rotation_.follow(Eigen::Vector3d::Zero(), V.tail<3>(), A.tail<3>());
  V_BD = V;
  A_BD = A;
}

void PoseMotion::advance(double dt) noexcept {
  if (!moving()) return;
  if (circling_) {
    circling_s_ += dt;
    circle_.at(circling_s_, &position_.x, &position_.v, &position_.a);
  } else {
    position_.advance(dt);
  }
  rotation_.advance(dt);
  update();
}

Pose PoseMotion::end() const noexcept {
  return {position_.end(), exp_rotation(rotation_.end()) * base_};
}

void PoseMotion::update() noexcept {
  const Eigen::Vector3d& r = rotation_.x;
  const Eigen::Matrix3d jacobian = left_jacobian(r);
  X_BD = {position_.x, (exp_rotation(r) * base_).normalized()};
  V_BD << position_.v, jacobian * rotation_.v;
  A_BD << position_.a, jacobian * rotation_.a + left_jacobian_rate(r, rotation_.v) * rotation_.v;
}

}  // namespace limber::controller
