// The part of controller_status_t that TorqueCycle answers for.
#include "controller/pose_error.h"
#include "controller/torque_cycle.h"

namespace limber::controller {
namespace {

void write(const VectorJ& tau, float (&field)[kMaxJoints]) noexcept {
  for (Eigen::Index i = 0; i < tau.size(); ++i) field[i] = static_cast<float>(tau[i]);
}

void write(const Vector6& vector, double (&field)[6]) noexcept { Vector6::Map(field) = vector; }

void write(const Pose& pose, double (&p)[3], double (&quat)[4]) noexcept {
  Eigen::Vector3d::Map(p) = pose.p;
  const double sign = pose.Q.w() < 0.0 ? -1.0 : 1.0;
  quat[0] = sign * pose.Q.w();
  for (int i = 0; i < 3; ++i) quat[i + 1] = sign * pose.Q.vec()[i];
}

}  // namespace

void TorqueCycle::describe(controller_status_t* status) noexcept {
  status->law = static_cast<std::int8_t>(selected_);
  status->num_joints = static_cast<std::int8_t>(model_.size());
  status->limits = limits_active_;
  status->kinetic_energy_J = terms_.kinetic_energy(seen_.v);
  status->spring_energy_J = law_.spring_energy_J;
  const LawSettings& settings = gains_.now().settings;
  for (std::size_t i = 0; i < kTerms; ++i) {
    status->term_period_cycles[i] = static_cast<std::int16_t>(settings.period_cycles[i]);
  }
  status->tank_energy_J = settings.tank_J > 0.0 ? tank_.energy_J() : 0.0;
  status->passivity_energy_J = passivity_.energy_J();
  status->contact = static_cast<std::int8_t>(settings.contact);
  describe_tip(status);
  describe_parts(status);
}

void TorqueCycle::describe_tip(controller_status_t* status) const noexcept {
  write(terms_.X_BT, status->p_BT, status->quat_BT);
  write(terms_.V_BT, status->V_BT);
  write(goal_.X_BD, status->p_BD, status->quat_BD);
  write(pose_error(terms_.X_BT, goal_.X_BD, active_.settings.orientation).e, status->e);
  write(law_.F, status->F_law);
  write(estimation_.estimates().F_ext, status->F_ext);
}

void TorqueCycle::describe_parts(controller_status_t* status) const noexcept {
  write(law_.tau_stiffness + law_.tau_feedforward, status->tau_stiffness);
  write(law_.tau_damping, status->tau_damping);
  write(tau_null_, status->tau_null);
  write(law_.sigma, status->sigma);
  status->fit_residual = static_cast<float>(law_.fit_residual);
  write(tau_gravity_, status->tau_gravity);
  write(tau_coriolis_, status->tau_coriolis);
  write(tau_friction_, status->tau_friction);
  write(estimation_.estimates().tau_ext, status->tau_ext);
  write(limits_.previous(), status->tau_sent);
}

}  // namespace limber::controller
