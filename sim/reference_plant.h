// Reduced coordinates: articulated-body algorithm and the classical Runge-Kutta method of order 4.
#pragma once

#include "sim/arm_plant.h"

namespace limber::sim {

/// Forces held over the step (friction, end stops) make the whole first order; without them it is
/// fourth order.
class ReferencePlant final : public ArmPlant {
 public:
  explicit ReferencePlant(const ArmModel& model);

 private:
  struct Slope {
    VectorJ v, qdd;
    Work power;
  };
  void integrate(ForceModel* forces, double h) noexcept override;
  void slope_at(const VectorJ& q, const VectorJ& v, ForceModel* forces, Slope* slope) noexcept;

  VectorJ tau_;
  VectorJ no_extra_inertia_;
  Slope k1_, k2_, k3_, k4_;
};

}  // namespace limber::sim
