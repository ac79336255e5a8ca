#include "controller/interpolation.h"

#include "controller/rotation.h"

namespace limber::controller {

PoseMotion::PoseMotion()
    : position_(Eigen::Vector3d::Zero()),
      rotation_(Eigen::Vector3d::Zero()),
      base_(Eigen::Quaterniond::Identity()) {}

void PoseMotion::reset(const Pose& rest) noexcept {
  position_.reset(rest.p);
  rotation_.reset(Eigen::Vector3d::Zero());
  base_ = rest.Q.normalized();
  update();
}

void PoseMotion::start(const Pose& end, double T) noexcept {
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

void PoseMotion::stop(double T) noexcept {
  position_.stop(T);
  rotation_.stop(T);
}

void PoseMotion::advance(double dt) noexcept {
  if (!moving()) return;
  position_.advance(dt);
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
