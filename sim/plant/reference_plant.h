// Reduced coordinates: the links of link_dynamics.h and the classical Runge-Kutta method of order 4
// over links and motors together.
#pragma once

#include <array>

#include "sim/plant/arm_plant.h"

namespace limber::sim {

/// Forces held over the step (friction, end stops, actuators that are not ideal) make the whole
/// first order; without them it is fourth order. Joint springs and dampers cut the step into parts
/// that leave a factor of four to the method's stability border.
class ReferencePlant final : public ArmPlant {
 public:
  explicit ReferencePlant(const ArmModel& model);

 private:
  struct Stage {
    ArmState x;
    VectorJ qdd;
    VectorM theta_ddot;
    Work power;
  };
  void integrate(ForceModel* forces, double h) noexcept override;
  int parts(const ForceModel& forces, double h) const noexcept override;
  /// Accelerations and power at the stage's state, where arm_ is.
  void accelerate(ForceModel* forces, Stage* stage) noexcept;
  /// The stage that lies h from x_ along the slope at `from`; arm_ goes there.
  void next(const Stage& from, double h, ForceModel* forces, Stage* stage) noexcept;

  ArmTorque tau_;
  std::array<double, kMaxMotors> link_inertia_{};  // least that a motor's spring may move
  Stage k1_, k2_, k3_, k4_;
};

}  // namespace limber::sim
