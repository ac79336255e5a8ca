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
  struct Slope {
    VectorJ v, qdd;
    VectorM theta_dot, theta_ddot;
    Work power;
  };
  void integrate(ForceModel* forces, double h) noexcept override;
  int parts(const ForceModel& forces, double h) const noexcept override;
  /// arm_ is at x.
  void slope_at(const ArmState& x, ForceModel* forces, Slope* slope) noexcept;
  /// h from x_ along the slope; arm_ goes there.
  ArmState moved(const Slope& slope, double h) noexcept;

  ArmTorque tau_;
  VectorJ no_extra_inertia_;
  std::array<double, kMaxMotors> link_inertia_{};  // least that a motor's spring may move
  Slope k1_, k2_, k3_, k4_;
};

}  // namespace limber::sim
