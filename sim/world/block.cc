#include "sim/world/block.h"

#include <Eigen/Geometry>
#include <cmath>

namespace limber::sim {
namespace {

Eigen::Matrix3d table_axes(const Eigen::Vector3d& normal) {
  const bool steep = std::abs(normal.x()) > 0.9;
  const Eigen::Vector3d forward = steep ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitX();
  Eigen::Matrix3d axes;
  axes.col(0) = (forward - normal.dot(forward) * normal).normalized();
  axes.col(1) = normal.cross(axes.col(0));
  axes.col(2) = normal;
  return axes;
}

}  // namespace

Block::Block(const Eigen::Vector3d& p, const Eigen::Vector3d& normal, double yaw,
             const Eigen::Vector3d& size, double mass, double table_friction,
             const Eigen::Vector3d& gravity) noexcept
    : table_(table_axes(normal)),
      p_(p),
      yaw_(yaw),
      size_(size),
      mass_(mass),
      table_friction_(table_friction),
      gravity_(gravity) {}

Eigen::Matrix3d Block::axes() const noexcept {
  return table_ * Eigen::AngleAxisd(yaw_, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

Touch Block::touch(const Eigen::Vector3d& p, double ball_radius) const noexcept {
  const Eigen::Matrix3d R = axes();
  // From the middle of the block, in its axes.
  const Eigen::Vector3d at = R.transpose() * (p - p_) - Eigen::Vector3d(0.0, 0.0, 0.5 * size_.z());
  const Eigen::Vector3d half = 0.5 * size_;
  const Eigen::Vector3d outside = at - at.cwiseMax(-half).cwiseMin(half);
  const double distance = outside.norm();
  if (distance > 0.0) return {R * (outside / distance), ball_radius - distance};
  // Inside: out by the nearest face, but not through the table.
  Eigen::Vector3d inside = half - at.cwiseAbs();
  inside.z() = half.z() - at.z();
  int face = 0;
  const double depth = inside.minCoeff(&face);
  const double side = face == 2 || at[face] >= 0.0 ? 1.0 : -1.0;
  return {side * R.col(face), ball_radius + depth};
}

Eigen::Vector3d Block::velocity_at(const Eigen::Vector3d& p) const noexcept {
  return v_ + yaw_rate_ * table_.col(2).cross(p - p_);
}

double Block::kinetic_energy() const noexcept {
  const double inertia = mass_ * (size_.head<2>().squaredNorm() / 12.0);
  return 0.5 * (mass_ * v_.squaredNorm() + inertia * yaw_rate_ * yaw_rate_);
}

void Block::advance(const Eigen::Vector3d& force, const Eigen::Vector3d& point, double h) noexcept {
  const Eigen::Vector3d n = table_.col(2);
  const double r = std::sqrt(size_.head<2>().squaredNorm() / 12.0);
  const Eigen::Vector3d total = force + mass_ * gravity_;
  const double moment = n.dot((point - p_).cross(force));
  // Velocities (v, r w) without friction at the step's end; each newton of either changes them
  // alike.
  Eigen::Vector3d v = v_ + h / mass_ * (total - n.dot(total) * n);
  double rw = r * yaw_rate_ + h / mass_ * moment / r;
  const double speed = std::sqrt(v.squaredNorm() + rw * rw);
  const double load = std::max(0.0, -n.dot(total));
  const double brake = h / mass_ * table_friction_ * load;
  const double left = speed > brake ? 1.0 - brake / speed : 0.0;
  const Eigen::Vector3d slowed = (left - 1.0) * v;  // by friction
  const double slowed_rw = (left - 1.0) * rw;
  v *= left;
  rw *= left;
  const Eigen::Vector3d v_mean = 0.5 * (v_ + v);
  const double w_mean = 0.5 * (yaw_rate_ + rw / r);
  work_contact_J_ += h * (force.dot(v_mean) + moment * w_mean);
  work_friction_J_ -= mass_ * (slowed.dot(v_mean) + slowed_rw * r * w_mean);
  v_ = v;
  yaw_rate_ = rw / r;
  p_ += h * v_;
  yaw_ += h * yaw_rate_;
  force_ = force;
}

void Block::fill(block_truth_t* truth) const noexcept {
  Eigen::Map<Eigen::Vector3d>(truth->p_BO) = p_;
  Eigen::Map<Eigen::Vector3d>(truth->v_BO) = v_;
  Eigen::Map<Eigen::Vector3d>(truth->F_contact) = force_;
  truth->yaw = yaw_;
  truth->yaw_rate = yaw_rate_;
  truth->kinetic_energy_J = kinetic_energy();
  truth->work_contact_J = work_contact_J_;
  truth->work_friction_J = work_friction_J_;
}

}  // namespace limber::sim
