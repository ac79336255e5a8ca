#include "sim/reference_plant.h"

namespace limber::sim {

ReferencePlant::ReferencePlant(const ArmModel& model)
    : ArmPlant(model),
      tau_(VectorJ::Zero(model.size())),
      no_extra_inertia_(VectorJ::Zero(model.size())) {}

void ReferencePlant::slope_at(const VectorJ& q, const VectorJ& v, ForceModel* forces,
                              Slope* slope) noexcept {
  arm_.set_state(q, v);
  forces->evaluate(&arm_, q, v, &tau_, &slope->power);
  slope->v = v;
  arm_.accelerations(tau_, no_extra_inertia_, &slope->qdd);
}

void ReferencePlant::integrate(ForceModel* forces, double h) noexcept {
  slope_at(q_, v_, forces, &k1_);
  slope_at(q_ + 0.5 * h * k1_.v, v_ + 0.5 * h * k1_.qdd, forces, &k2_);
  slope_at(q_ + 0.5 * h * k2_.v, v_ + 0.5 * h * k2_.qdd, forces, &k3_);
  slope_at(q_ + h * k3_.v, v_ + h * k3_.qdd, forces, &k4_);
  q_ += h / 6.0 * (k1_.v + 2.0 * k2_.v + 2.0 * k3_.v + k4_.v);
  v_ += h / 6.0 * (k1_.qdd + 2.0 * k2_.qdd + 2.0 * k3_.qdd + k4_.qdd);
  arm_.set_state(q_, v_);
  const auto add = [&](double Work::*part) {
    work_.*part +=
        h / 6.0 *
        (k1_.power.*part + 2.0 * k2_.power.*part + 2.0 * k3_.power.*part + k4_.power.*part);
  };
  add(&Work::motor);
  add(&Work::external);
  add(&Work::friction);
}

}  // namespace limber::sim
