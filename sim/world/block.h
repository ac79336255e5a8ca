// A block that slides on a table and never tips or lifts: three degrees of freedom, and Coulomb's
// friction under all of its base.
//
//   m dv/dt = F + m g - f,   I dw/dt = M - t,   I = m (a^2 + b^2) / 12 for edges a, b
//
// Friction (f, t) lies within an ellipsoid, the usual approximation of the limit surface of a
// sliding base (Goyal, Ruina, Papadopoulos, Wear 143, 1991): |(f, t / r)| <= mu N, along
// (v, r w) while it slides, N the weight and what presses from above. With r = sqrt(I / m), 6 %
// more than even pressure under a square would give, one step of it is solved in closed form: it
// sticks, or slows along (v, r w).
#pragma once

#include <limber/block_truth_t.hpp>

#include "sim/world/ball_contact.h"

namespace limber::sim {

/// Base axes. Allowed in the cycle throughout.
class Block {
 public:
  Block() = default;
  /// At rest; `p`: centre of the base; `gravity`: m/s^2.
  Block(const Eigen::Vector3d& p, const Eigen::Vector3d& normal, double yaw,
        const Eigen::Vector3d& size, double mass, double table_friction,
        const Eigen::Vector3d& gravity) noexcept;

  Touch touch(const Eigen::Vector3d& p, double ball_radius) const noexcept;
  /// Velocity of the block's point at p.
  Eigen::Vector3d velocity_at(const Eigen::Vector3d& p) const noexcept;
  /// Most that a newton at its surface may accelerate it there, 1/kg.
  double mobility() const noexcept { return 4.0 / mass_; }

  /// One step of h seconds under a force at a point; velocity first, then position. Work is of mean
  /// velocities, so that energies balance to rounding.
  void advance(const Eigen::Vector3d& force, const Eigen::Vector3d& point, double h) noexcept;

  /// All but seq and time.
  void fill(block_truth_t* truth) const noexcept;

 private:
  Eigen::Matrix3d axes() const noexcept;
  double kinetic_energy() const noexcept;

  Eigen::Matrix3d table_ = Eigen::Matrix3d::Identity();  ///< its axes, the normal last
  Eigen::Vector3d p_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_ = Eigen::Vector3d::Zero();  ///< along the table
  double yaw_ = 0.0;
  double yaw_rate_ = 0.0;
  Eigen::Vector3d size_ = Eigen::Vector3d::Ones();
  double mass_ = 1.0;
  double table_friction_ = 0.0;
  Eigen::Vector3d gravity_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();  ///< of the tip, in the last step
  double work_contact_J_ = 0.0;
  double work_friction_J_ = 0.0;
};

}  // namespace limber::sim
