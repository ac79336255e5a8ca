#include "sim/plant/articulated_body.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

namespace limber::sim {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d cross_matrix(const Vector3d& a) {
  Matrix3d m;
  m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return m;
}

}  // namespace

ArticulatedBody::ArticulatedBody(ArmModel model)
    : model_(std::move(model)), bare_tip_body_(model_.bodies.back().mass) {
  set_state(VectorJ::Zero(size()), VectorJ::Zero(size()));
}

void ArticulatedBody::set_tip_load(double mass, const Vector3d& p_TL) noexcept {
  const LinkModel& tip_link = model_.links.back();
  model_.bodies.back().mass = with_point_mass(bare_tip_body_, mass, tip_link.p + tip_link.R * p_TL);
}

void ArticulatedBody::set_state(const VectorJ& q, const VectorJ& v) noexcept {
  v_ = v;
  for (int i = 0; i < size(); ++i) place(i, q[i], v[i]);
}

void ArticulatedBody::place(int i, double q, double v) noexcept {
  const BodyModel& body = model_.bodies[i];
  BodyState& s = state_[i];
  const Matrix3d R_parent = body_rotation(i - 1);
  const Vector3d w_parent = angular_velocity(i - 1);
  const Vector3d v_parent = i > 0 ? state_[i - 1].v : Vector3d::Zero();

  const Matrix3d R_zero = R_parent * body.R_PJ;
  s.z = R_zero * body.axis;
  s.r = R_parent * body.p_PJ;
  if (body.prismatic) s.r += q * s.z;
  s.p = body_position(i - 1) + s.r;
  s.v = v_parent + w_parent.cross(s.r);
  s.c_lin = w_parent.cross(w_parent.cross(s.r));
  if (body.prismatic) {
    s.R = R_zero;
    s.w = w_parent;
    s.v += v * s.z;
    s.c_lin += 2.0 * v * w_parent.cross(s.z);
    s.c_ang.setZero();
  } else {
    s.R = R_zero * Eigen::AngleAxisd(q, body.axis).toRotationMatrix();
    s.w = w_parent + v * s.z;
    s.c_ang = v * w_parent.cross(s.z);
  }

  s.c = s.R * body.mass.com;
  s.I = s.R * body.mass.inertia * s.R.transpose();
  s.f_bias = body.mass.mass * s.w.cross(s.w.cross(s.c));
  s.n_bias = s.w.cross(s.I * s.w) + s.c.cross(s.f_bias);
  s.f_ext.setZero();
  s.n_ext.setZero();
}

void ArticulatedBody::clear_wrenches() noexcept {
  for (int i = 0; i < size(); ++i) {
    state_[i].f_ext.setZero();
    state_[i].n_ext.setZero();
  }
}

void ArticulatedBody::add_wrench(int body, const Vector3d& point, const Vector3d& force,
                                 const Vector3d& moment) noexcept {
  if (body < 0) return;
  state_[body].f_ext += force;
  state_[body].n_ext += moment + (point - state_[body].p).cross(force);
}

void ArticulatedBody::wrench_torque(VectorJ* tau) const noexcept {
  Vector3d force = Vector3d::Zero();
  Vector3d moment = Vector3d::Zero();
  tau->resize(size());
  for (int i = size() - 1; i >= 0; --i) {
    force += state_[i].f_ext;
    moment += state_[i].n_ext;
    (*tau)[i] = state_[i].z.dot(model_.bodies[i].prismatic ? force : moment);
    moment += state_[i].r.cross(force);
  }
}

void ArticulatedBody::start(int i) noexcept {
  const BodyState& s = state_[i];
  const double mass = model_.bodies[i].mass.mass;
  const Matrix3d c = cross_matrix(s.c);
  Articulated& a = sweep_[i];
  a.A = mass * Matrix3d::Identity();
  a.H = -mass * c;
  a.J = s.I - mass * c * c;
  a.f = s.f_bias - s.f_ext;
  a.n = s.n_bias - s.n_ext;
}

void ArticulatedBody::reduce(int i, double tau, double extra_inertia) noexcept {
  const BodyModel& body = model_.bodies[i];
  const Vector3d& z = state_[i].z;
  Articulated& a = sweep_[i];
  if (body.prismatic) {
    a.U_f = a.A * z;
    a.U_n = a.H.transpose() * z;
    a.d = z.dot(a.U_f);
    a.u = tau - z.dot(a.f);
  } else {
    a.U_f = a.H * z;
    a.U_n = a.J * z;
    a.d = z.dot(a.U_n);
    a.u = tau - z.dot(a.n);
  }
  a.d += body.rotor_inertia + extra_inertia;
}

void ArticulatedBody::hand_down(int i) noexcept {
  const BodyState& s = state_[i];
  const Articulated& a = sweep_[i];
  Articulated& parent = sweep_[i - 1];
  const Matrix3d A = a.A - a.U_f * a.U_f.transpose() / a.d;
  const Matrix3d H = a.H - a.U_f * a.U_n.transpose() / a.d;
  const Matrix3d J = a.J - a.U_n * a.U_n.transpose() / a.d;
  const Vector3d f = a.f + A * s.c_lin + H * s.c_ang + a.U_f * (a.u / a.d);
  const Vector3d n = a.n + H.transpose() * s.c_lin + J * s.c_ang + a.U_n * (a.u / a.d);

  const Matrix3d r = cross_matrix(s.r);
  const Matrix3d H_shifted = H - A * r;
  parent.A += A;
  parent.H += H_shifted;
  parent.J += J + r * H_shifted - H.transpose() * r;
  parent.f += f;
  parent.n += n + s.r.cross(f);
}

void ArticulatedBody::accelerations(const VectorJ& tau, const VectorJ& extra_inertia,
                                    VectorJ* qdd) noexcept {
  for (int i = 0; i < size(); ++i) start(i);
  for (int i = size() - 1; i >= 0; --i) {
    reduce(i, tau[i], extra_inertia[i]);
    if (i > 0) hand_down(i);
  }
  // Gravity as an acceleration of the base upwards.
  Vector3d a_lin = -model_.gravity;
  Vector3d a_ang = Vector3d::Zero();
  qdd->resize(size());
  for (int i = 0; i < size(); ++i) {
    const BodyState& s = state_[i];
    const Articulated& a = sweep_[i];
    a_lin += a_ang.cross(s.r) + s.c_lin;
    a_ang += s.c_ang;
    const double acceleration = (a.u - a.U_f.dot(a_lin) - a.U_n.dot(a_ang)) / a.d;
    (model_.bodies[i].prismatic ? a_lin : a_ang) += acceleration * s.z;
    (*qdd)[i] = acceleration;
  }
}

double ArticulatedBody::tip_mobility(const Vector3d& n) noexcept {
  const VectorJ zero = VectorJ::Zero(size());
  const Vector3d p = link_position(tip());
  VectorJ without;
  VectorJ with;
  clear_wrenches();
  accelerations(zero, zero, &without);
  add_wrench(model_.links[tip()].body, p, n, Vector3d::Zero());
  VectorJ tau;
  wrench_torque(&tau);  // J^T n
  accelerations(zero, zero, &with);
  clear_wrenches();
  return std::max(tau.dot(with - without), 0.0);
}

Vector3d ArticulatedBody::body_position(int body) const noexcept {
  return body >= 0 ? state_[body].p : Vector3d::Zero();
}

Matrix3d ArticulatedBody::body_rotation(int body) const noexcept {
  return body >= 0 ? state_[body].R : Matrix3d::Identity();
}

Vector3d ArticulatedBody::angular_velocity(int body) const noexcept {
  return body >= 0 ? state_[body].w : Vector3d::Zero();
}

Vector3d ArticulatedBody::point_velocity(int body, const Vector3d& point) const noexcept {
  if (body < 0) return Vector3d::Zero();
  return state_[body].v + state_[body].w.cross(point - state_[body].p);
}

Vector3d ArticulatedBody::link_position(int link) const noexcept {
  const LinkModel& l = model_.links[link];
  return body_position(l.body) + body_rotation(l.body) * l.p;
}

Matrix3d ArticulatedBody::link_rotation(int link) const noexcept {
  return body_rotation(model_.links[link].body) * model_.links[link].R;
}

Vector3d ArticulatedBody::link_velocity(int link) const noexcept {
  return point_velocity(model_.links[link].body, link_position(link));
}

Vector3d ArticulatedBody::link_angular_velocity(int link) const noexcept {
  return angular_velocity(model_.links[link].body);
}

double ArticulatedBody::kinetic_energy() const noexcept {
  double twice = 0.0;
  for (int i = 0; i < size(); ++i) {
    const BodyState& s = state_[i];
    const BodyModel& body = model_.bodies[i];
    twice += body.mass.mass * (s.v + s.w.cross(s.c)).squaredNorm() + s.w.dot(s.I * s.w) +
             body.rotor_inertia * v_[i] * v_[i];
  }
  return 0.5 * twice;
}

double ArticulatedBody::potential_energy() const noexcept {
  double energy = 0.0;
  for (int i = 0; i < size(); ++i) {
    energy -= model_.bodies[i].mass.mass * model_.gravity.dot(state_[i].p + state_[i].c);
  }
  return energy;
}

}  // namespace limber::sim
