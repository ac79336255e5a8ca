#include "sim/plant/reference_plant.h"

#include <algorithm>
#include <cmath>

namespace limber::sim {

ReferencePlant::ReferencePlant(const ArmModel& model)
    : ArmPlant(model), no_extra_inertia_(VectorJ::Zero(model.chain.size())) {
  tau_.link = VectorJ::Zero(model.chain.size());
  tau_.motor = VectorM::Zero(x_.theta.size());
  for (std::size_t k = 0; k < motors().size(); ++k) {
    // Two springs at one link make it stiffer; each gets half of it.
    const auto pulls_here = [&](const MotorModel& motor) {
      return motor.joint == motors()[k].joint;
    };
    const auto springs = std::count_if(motors().begin(), motors().end(), pulls_here);
    link_inertia_[k] =
        model.chain.bodies[motors()[k].joint].own_inertia() / static_cast<double>(springs);
  }
}

int ReferencePlant::parts(const ForceModel& forces, double h) const noexcept {
  constexpr double kBorder = 2.785;  // of the method on the negative real axis; 2.83 sideways
  constexpr double kMargin = 4.0;
  constexpr double kMost = 1000.0;
  double fastest = 0.0;
  for (std::size_t k = 0; k < motors().size(); ++k) {
    const int motor = static_cast<int>(k);
    fastest = std::max(fastest, forces.fastest_rate(x_, motor, link_inertia_[k], h));
  }
  return static_cast<int>(std::clamp(std::ceil(h * fastest * kMargin / kBorder), 1.0, kMost));
}

void ReferencePlant::slope_at(const ArmState& x, ForceModel* forces, Slope* slope) noexcept {
  forces->evaluate(&arm_, x, &tau_, &slope->power);
  slope->v = x.v;
  slope->theta_dot = x.theta_dot;
  arm_.accelerations(tau_.link, no_extra_inertia_, &slope->qdd);
  slope->theta_ddot = tau_.motor;
  for (std::size_t k = 0; k < motors().size(); ++k) {
    const MotorModel& motor = motors()[k];
    if (motor.rigid) {
      slope->theta_ddot[k] = slope->qdd[motor.joint];
    } else {
      slope->theta_ddot[k] /= motor.inertia;
    }
  }
}

ArmState ReferencePlant::moved(const Slope& slope, double h) noexcept {
  const ArmState x{x_.q + h * slope.v, x_.v + h * slope.qdd, x_.theta + h * slope.theta_dot,
                   x_.theta_dot + h * slope.theta_ddot};
  arm_.set_state(x.q, x.v);
  return x;
}

void ReferencePlant::integrate(ForceModel* forces, double h) noexcept {
  slope_at(x_, forces, &k1_);
  slope_at(moved(k1_, 0.5 * h), forces, &k2_);
  slope_at(moved(k2_, 0.5 * h), forces, &k3_);
  slope_at(moved(k3_, h), forces, &k4_);
  const auto advance = [&](auto* value, auto Slope::*rate) {
    *value += h / 6.0 * (k1_.*rate + 2.0 * k2_.*rate + 2.0 * k3_.*rate + k4_.*rate);
  };
  advance(&x_.q, &Slope::v);
  advance(&x_.v, &Slope::qdd);
  advance(&x_.theta, &Slope::theta_dot);
  advance(&x_.theta_dot, &Slope::theta_ddot);
  carry_rotors();
  arm_.set_state(x_.q, x_.v);
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
