#include "sim/plant/reference_plant.h"

#include <algorithm>
#include <cmath>

namespace limber::sim {

ReferencePlant::ReferencePlant(const ArmModel& model) : ArmPlant(model) {
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
    if (motors()[k].rigid) continue;
    const int motor = static_cast<int>(k);
    fastest = std::max(fastest, forces.fastest_rate(x_, motor, link_inertia_[k], h));
  }
  return static_cast<int>(std::clamp(std::ceil(h * fastest * kMargin / kBorder), 1.0, kMost));
}

void ReferencePlant::accelerate(ForceModel* forces, Stage* stage) noexcept {
  forces->evaluate(&arm_, stage->x, &tau_, &stage->power);
  arm_.accelerations(tau_.link, &stage->qdd);
  stage->theta_ddot.resize(tau_.motor.size());
  for (std::size_t k = 0; k < motors().size(); ++k) {
    const MotorModel& motor = motors()[k];
    stage->theta_ddot[k] = motor.rigid ? stage->qdd[motor.joint] : tau_.motor[k] / motor.inertia;
  }
}

void ReferencePlant::next(const Stage& from, double h, ForceModel* forces, Stage* stage) noexcept {
  stage->x.q = x_.q + h * from.x.v;
  stage->x.v = x_.v + h * from.qdd;
  stage->x.theta = x_.theta + h * from.x.theta_dot;
  stage->x.theta_dot = x_.theta_dot + h * from.theta_ddot;
  arm_.set_state(stage->x.q, stage->x.v);
  accelerate(forces, stage);
}

void ReferencePlant::integrate(ForceModel* forces, double h) noexcept {
  k1_.x = x_;
  accelerate(forces, &k1_);
  next(k1_, 0.5 * h, forces, &k2_);
  next(k2_, 0.5 * h, forces, &k3_);
  next(k3_, h, forces, &k4_);
  const auto step = [&](const auto& k1, const auto& k2, const auto& k3, const auto& k4) {
    return h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  };
  x_.q += step(k1_.x.v, k2_.x.v, k3_.x.v, k4_.x.v);
  x_.v += step(k1_.qdd, k2_.qdd, k3_.qdd, k4_.qdd);
  x_.theta += step(k1_.x.theta_dot, k2_.x.theta_dot, k3_.x.theta_dot, k4_.x.theta_dot);
  x_.theta_dot += step(k1_.theta_ddot, k2_.theta_ddot, k3_.theta_ddot, k4_.theta_ddot);
  carry_rotors();
  arm_.set_state(x_.q, x_.v);
  const auto add = [&](double Work::*part) {
    work_.*part += step(k1_.power.*part, k2_.power.*part, k3_.power.*part, k4_.power.*part);
  };
  add(&Work::motor);
  add(&Work::external);
  add(&Work::friction);
}

}  // namespace limber::sim
