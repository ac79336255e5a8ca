#include "sim/arm_plant.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include "common/config_error.h"
#include "sim/ode_plant.h"
#include "sim/reference_plant.h"

namespace limber::sim {
namespace {

/// Smallest inertia a joint may move: far below the smallest rotor, far above rounding.
constexpr double kMinInertia = 1e-9;

void require_inertia(const ArmModel& model) {
  // Inertia of everything beyond a joint about its axis is smallest when the joints behind it are
  // free; a joint whose own body and rotor have some is fit whatever is behind it.
  for (int i = model.size() - 1; i >= 0; --i) {
    const BodyModel& body = model.bodies[i];
    const Eigen::Vector3d arm = body.mass.com.cross(body.axis);
    const double own = body.prismatic ? body.mass.mass
                                      : body.axis.dot(body.mass.inertia * body.axis) +
                                            body.mass.mass * arm.squaredNorm();
    if (own + body.rotor_inertia > kMinInertia) continue;
    throw ConfigError(
        fmt::format("joint {} moves a link without inertia and has no rotor_inertia_kgm2: its "
                    "acceleration is undefined",
                    i + 1));
  }
}

}  // namespace

ArmPlant::ArmPlant(const ArmModel& model)
    : arm_(model), q_(VectorJ::Zero(model.size())), v_(VectorJ::Zero(model.size())) {}

void ArmPlant::set_state(const VectorJ& q, const VectorJ& v) noexcept {
  q_ = q;
  v_ = v;
  arm_.set_state(q_, v_);
  state_was_set();
}

void ArmPlant::step(ForceModel* forces, double h, std::int64_t t_ns) noexcept {
  const VectorJ q = q_;
  const VectorJ v = v_;
  const Work work = work_;
  forces->begin_step(&arm_, q_, v_, h, t_ns);
  integrate(forces, h);
  if (q_.allFinite() && v_.allFinite() && v_.cwiseAbs().maxCoeff() <= kMaxSpeed) return;
  ++diverged_;
  work_ = work;
  set_state(q, VectorJ::Zero(v.size()));
}

void ArmPlant::set_payload(double mass, const Eigen::Vector3d& p_TL) noexcept {
  arm_.set_tip_load(mass, p_TL);
  arm_.set_state(q_, v_);
  payload_was_set();
}

VectorJ ArmPlant::external_torque(const Environment& environment, std::int64_t t_ns) noexcept {
  VectorJ tau;
  environment.apply(&arm_, t_ns);
  arm_.wrench_torque(&tau);
  return tau;
}

std::unique_ptr<ArmPlant> make_arm_plant(Integrator integrator, const ArmModel& model) {
  require_inertia(model);
  if (integrator == Integrator::kReference) return std::make_unique<ReferencePlant>(model);
  return std::make_unique<OdePlant>(model);
}

}  // namespace limber::sim
