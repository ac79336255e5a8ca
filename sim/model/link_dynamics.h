// The links of a serial arm: where they are, how they move, and what accelerates them.
//
//   (M(q) + B) qdd + C(q,v) v + g(q) = tau + sum_i J_i^T F_i
//
// M, C v and g from dynamics/arm_kernel.h, once a state; then one L D L^T for each question.
#pragma once

#include <array>

#include "dynamics/arm_kernel.h"
#include "sim/model/arm_model.h"

namespace limber::sim {

/// Everything in base axes. Bodies as in dynamics::BodyChain, body -1 is the base; links are
/// numbered as its frames. No member but the constructor allocates; all may be called in the cycle.
class LinkDynamics {
 public:
  /// At rest at zero.
  explicit LinkDynamics(ArmModel model);

  int size() const noexcept { return model_.chain.size(); }
  const ArmModel& model() const noexcept { return model_; }
  /// With the tip load.
  const dynamics::MassProperties& mass(int body) const noexcept {
    return model_.chain.bodies[static_cast<std::size_t>(body)].mass;
  }
  bool prismatic(int body) const noexcept {
    return model_.chain.bodies[static_cast<std::size_t>(body)].prismatic;
  }

  /// A point mass at p_TL in tip axes, kg and m; 0 removes it. Replaces an earlier one. Acts from
  /// the next set_state() on.
  void set_tip_load(double mass, const Eigen::Vector3d& p_TL) noexcept;

  /// Wrenches are cleared.
  void set_state(const VectorJ& q, const VectorJ& v) noexcept;

  void clear_wrenches() noexcept;
  /// The world pushes `body` with a force at `point` (base frame) and a moment. The base takes it
  /// in silence.
  void add_wrench(int body, const Eigen::Vector3d& point, const Eigen::Vector3d& force,
                  const Eigen::Vector3d& moment) noexcept;
  /// Sum of the wrenches added to a body, at the base origin.
  const Vector6& external_wrench(int body) const noexcept {
    return F_ext_[static_cast<std::size_t>(body)];
  }
  /// Joint torque of the wrenches added: sum J_i^T F_i.
  const VectorJ& wrench_torque() const noexcept { return tau_ext_; }
  /// Torque that holds the links against gravity.
  VectorJ gravity_torque() const noexcept;

  /// Acceleration at the present state.
  void accelerations(const VectorJ& tau, VectorJ* qdd) const noexcept;
  /// With `extra_inertia` added to B: an implicit integrator's h*damping.
  void accelerations(const VectorJ& tau, const VectorJ& extra_inertia, VectorJ* qdd) const noexcept;

  /// n^T J (M + B)^-1 J^T n for the tip origin and a unit vector n: how fast a newton along n
  /// accelerates the tip along n, 1/kg; 0 where the arm cannot move that way.
  double tip_mobility(const Eigen::Vector3d& n) const noexcept;

  int tip() const noexcept { return static_cast<int>(model_.chain.frames.size()) - 1; }
  int body_of(int link) const noexcept {
    return model_.chain.frames[static_cast<std::size_t>(link)].body;
  }
  Eigen::Vector3d link_position(int link) const noexcept;
  Eigen::Matrix3d link_rotation(int link) const noexcept;
  Eigen::Vector3d link_velocity(int link) const noexcept;
  Eigen::Vector3d link_angular_velocity(int link) const noexcept;

  Eigen::Vector3d body_position(int body) const noexcept;
  Eigen::Matrix3d body_rotation(int body) const noexcept;
  Eigen::Vector3d centre_of_mass(int body) const noexcept;
  Eigen::Vector3d joint_axis(int body) const noexcept;
  /// Velocity of the point of the body that is at `point` (base frame).
  Eigen::Vector3d point_velocity(int body, const Eigen::Vector3d& point) const noexcept;
  Eigen::Vector3d angular_velocity(int body) const noexcept;

  /// Of all links and rotors, J.
  double kinetic_energy() const noexcept { return 0.5 * v_.dot(M_ * v_); }
  /// Of gravity, zero with every mass at the height of the base origin, J.
  double potential_energy() const noexcept;

 private:
  ArmModel model_;
  dynamics::MassProperties bare_tip_body_;
  dynamics::AnyArmKernel kernel_;
  VectorJ v_, zero_;
  MatrixJ M_;           // with B
  VectorJ bias_;        // C v + g
  bool pushed_ = true;  // wrenches have been added
  VectorJ tau_ext_;     // of the wrenches
  std::array<Vector6, kMaxJoints> F_ext_;
};

}  // namespace limber::sim
