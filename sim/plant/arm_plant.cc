#include "sim/plant/arm_plant.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include "common/config_error.h"
#include "sim/plant/ode_plant.h"
#include "sim/plant/reference_plant.h"

namespace limber::sim {
namespace {

/// Smallest inertia a joint may move: far below the smallest rotor, far above rounding.
constexpr double kMinInertia = 1e-9;

void require_inertia(const ArmModel& model) {
  // Inertia of everything beyond a joint about its axis is smallest when the joints behind it are
  // free; a joint whose own body and rotor have some is fit whatever is behind it.
  for (int i = model.chain.size() - 1; i >= 0; --i) {
    if (model.chain.bodies[i].own_inertia() + model.rotor_inertia[i] > kMinInertia) continue;
    throw ConfigError(
        fmt::format("joint {} moves a link without inertia and has no rotor_inertia_kgm2: its "
                    "acceleration is undefined",
                    i + 1));
  }
  for (const MotorModel& motor : model.motors) {
    if (motor.rigid || motor.inertia > kMinInertia) continue;
    throw ConfigError(
        fmt::format("a motor of joint {} is behind a spring and has no rotor_inertia_kgm2: its "
                    "acceleration is undefined",
                    motor.joint + 1));
  }
}

}  // namespace

ArmPlant::ArmPlant(const ArmModel& model) : arm_(model) {
  x_.q = x_.v = VectorJ::Zero(model.chain.size());
  x_.theta = x_.theta_dot = VectorM::Zero(static_cast<int>(model.motors.size()));
}

void ArmPlant::set_state(const VectorJ& q, const VectorJ& v) noexcept {
  ArmState x = x_;
  x.q = q;
  x.v = v;
  for (std::size_t k = 0; k < motors().size(); ++k) {
    const MotorModel& motor = motors()[k];
    x.theta[k] = motor.side * q[motor.joint];
    x.theta_dot[k] = motor.side * v[motor.joint];
  }
  set_state(x);
}

void ArmPlant::set_state(const ArmState& x) noexcept {
  x_ = x;
  carry_rotors();
  arm_.set_state(x_.q, x_.v);
  state_was_set();
}

void ArmPlant::carry_rotors() noexcept {
  for (std::size_t k = 0; k < motors().size(); ++k) {
    if (!motors()[k].rigid) continue;
    x_.theta[k] = x_.q[motors()[k].joint];
    x_.theta_dot[k] = x_.v[motors()[k].joint];
  }
}

void ArmPlant::step(ForceModel* forces, double h, std::int64_t t_ns) noexcept {
  const ArmState before = x_;
  const Work work = work_;
  const int count = parts(*forces, h);
  for (int i = 0; i < count; ++i) {
    forces->begin_step(&arm_, x_, h / count, t_ns);
    integrate(forces, h / count);
  }
  if (x_.finite_and_slower_than(kMaxSpeed)) return;
  ++diverged_;
  work_ = work;
  x_ = before;
  x_.v.setZero();
  x_.theta_dot.setZero();
  set_state(ArmState(x_));
}

double ArmPlant::kinetic_energy() const noexcept {
  double energy = arm_.kinetic_energy();
  for (std::size_t k = 0; k < motors().size(); ++k) {
    energy += 0.5 * motors()[k].inertia * x_.theta_dot[k] * x_.theta_dot[k];
  }
  return energy;
}

void ArmPlant::set_payload(double mass, const Eigen::Vector3d& p_TL) noexcept {
  arm_.set_tip_load(mass, p_TL);
  arm_.set_state(x_.q, x_.v);
  payload_was_set();
}

const VectorJ& ArmPlant::external_torque(const Environment& environment,
                                         std::int64_t t_ns) noexcept {
  environment.apply(&arm_, t_ns);
  return arm_.wrench_torque();
}

std::unique_ptr<ArmPlant> make_arm_plant(Integrator integrator, const ArmModel& model) {
  require_inertia(model);
  if (integrator == Integrator::kReference) return std::make_unique<ReferencePlant>(model);
  return std::make_unique<OdePlant>(model);
}

}  // namespace limber::sim
