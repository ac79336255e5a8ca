#include "sim/model/link_dynamics.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "dynamics/spd_solve.h"

namespace limber::sim {
namespace {

using dynamics::FixedFrame;
using Eigen::Matrix3d;
using Eigen::Vector3d;

}  // namespace

LinkDynamics::LinkDynamics(ArmModel model)
    : model_(std::move(model)),
      bare_tip_body_(model_.chain.bodies.back().mass),
      kernel_(dynamics::arm_kernel(model_.chain, model_.gravity)),
      zero_(VectorJ::Zero(size())),
      M_(size(), size()),
      bias_(zero_) {
  set_state(zero_, zero_);
}

void LinkDynamics::set_tip_load(double mass, const Vector3d& p_TL) noexcept {
  const FixedFrame& tip_frame = model_.chain.frames.back();
  dynamics::MassProperties& last = model_.chain.bodies.back().mass;
  last = with_point_mass(bare_tip_body_, mass, tip_frame.p + tip_frame.R * p_TL);
  kernel_->set_mass(size() - 1, last);
}

void LinkDynamics::set_state(const VectorJ& q, const VectorJ& v) noexcept {
  v_ = v;
  VectorJ g(size());
  kernel_->place(q);
  kernel_->weigh();
  kernel_->move(v, zero_);
  kernel_->mass(&M_);
  kernel_->torque(&bias_, nullptr);
  kernel_->gravity(&g, nullptr);
  M_.diagonal() += model_.rotor_inertia;
  bias_ += g;
  clear_wrenches();
}

void LinkDynamics::clear_wrenches() noexcept {
  if (!pushed_) return;
  pushed_ = false;
  tau_ext_ = zero_;
  std::fill_n(F_ext_.begin(), size(), Vector6::Zero());
}

void LinkDynamics::add_wrench(int body, const Vector3d& point, const Vector3d& force,
                              const Vector3d& moment) noexcept {
  if (body < 0) return;
  pushed_ = true;
  Vector6 F;
  F << force, moment + point.cross(force);
  F_ext_[static_cast<std::size_t>(body)] += F;
  kernel_->add_wrench(body, F, &tau_ext_);
}

VectorJ LinkDynamics::gravity_torque() const noexcept {
  VectorJ g(size());
  kernel_->gravity(&g, nullptr);
  return g;
}

void LinkDynamics::accelerations(const VectorJ& tau, VectorJ* qdd) const noexcept {
  *qdd = tau + tau_ext_ - bias_;
  dynamics::solve_spd(M_, qdd);
}

void LinkDynamics::accelerations(const VectorJ& tau, const VectorJ& extra_inertia,
                                 VectorJ* qdd) const noexcept {
  MatrixJ inertia = M_;
  inertia.diagonal() += extra_inertia;
  *qdd = tau + tau_ext_ - bias_;
  dynamics::solve_spd(inertia, qdd);
}

double LinkDynamics::tip_mobility(const Vector3d& n) const noexcept {
  Vector6 F;
  F << n, link_position(tip()).cross(n);
  VectorJ tau = zero_;
  kernel_->add_wrench(body_of(tip()), F, &tau);
  VectorJ qdd = tau;
  dynamics::solve_spd(M_, &qdd);
  return std::max(tau.dot(qdd), 0.0);
}

Vector3d LinkDynamics::body_position(int body) const noexcept {
  if (body < 0) return Vector3d::Zero();
  return kernel_->position(body);
}

Matrix3d LinkDynamics::body_rotation(int body) const noexcept {
  if (body < 0) return Matrix3d::Identity();
  return kernel_->rotation(body);
}

Vector3d LinkDynamics::centre_of_mass(int body) const noexcept {
  return kernel_->centre_of_mass(body);
}

Vector3d LinkDynamics::joint_axis(int body) const noexcept { return kernel_->axis(body); }

Vector3d LinkDynamics::angular_velocity(int body) const noexcept {
  if (body < 0) return Vector3d::Zero();
  return kernel_->twist(body).tail<3>();
}

Vector3d LinkDynamics::point_velocity(int body, const Vector3d& point) const noexcept {
  if (body < 0) return Vector3d::Zero();
  const Vector6 V = kernel_->twist(body);
  return V.head<3>() + V.tail<3>().cross(point);
}

Vector3d LinkDynamics::link_position(int link) const noexcept {
  const FixedFrame& frame = model_.chain.frames[static_cast<std::size_t>(link)];
  return body_position(frame.body) + body_rotation(frame.body) * frame.p;
}

Matrix3d LinkDynamics::link_rotation(int link) const noexcept {
  const FixedFrame& frame = model_.chain.frames[static_cast<std::size_t>(link)];
  return body_rotation(frame.body) * frame.R;
}

Vector3d LinkDynamics::link_velocity(int link) const noexcept {
  return point_velocity(body_of(link), link_position(link));
}

Vector3d LinkDynamics::link_angular_velocity(int link) const noexcept {
  return angular_velocity(body_of(link));
}

double LinkDynamics::potential_energy() const noexcept { return kernel_->potential_energy(); }

}  // namespace limber::sim
