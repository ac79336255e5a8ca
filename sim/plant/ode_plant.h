// Maximal coordinates: one ODE body a link, one ODE hinge or slider a joint, dWorldStep.
#pragma once

#include <ode/ode.h>

#include <array>

#include "sim/plant/arm_plant.h"

namespace limber::sim {

/// First order in the step. Rotor inertia has no place in ODE's bodies; each joint gets tau - B qdd
/// instead of tau, with qdd from link_dynamics.h under the very same forces, so that
/// the links feel M + B. Motors behind springs move beside ODE, one implicit step each
/// (sim/joints/coupling.h), and come in the same way: tau - B' qdd, B' what the link feels of them.
class OdePlant final : public ArmPlant {
 public:
  /// ODE wants every body to have mass and a positive definite inertia: throws ConfigError where a
  /// moving link has not (the reference integrator takes such arms).
  explicit OdePlant(const ArmModel& model);
  ~OdePlant() override;

 private:
  void integrate(ForceModel* forces, double h) noexcept override;
  void state_was_set() noexcept override;
  void payload_was_set() noexcept override;

  void create(int i);
  /// Bodies to the zero posture, masses and joint anchors of the model, then back to x_.
  void assemble() noexcept;
  void place_bodies(const LinkDynamics& arm) noexcept;
  void apply(const VectorJ& tau) noexcept;
  void read_joints() noexcept;

  dWorldID world_;
  dThreadingImplementationID threading_;  ///< its own: ODE's default is one for all worlds
  dJointGroupID joints_;
  std::array<dBodyID, kMaxJoints> body_{};
  std::array<dJointID, kMaxJoints> joint_{};
  VectorJ tau_, qdd_, extra_inertia_;
  VectorM theta_ddot_;
};

}  // namespace limber::sim
