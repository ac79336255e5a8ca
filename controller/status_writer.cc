#include "controller/status_writer.h"

#include <algorithm>

#include "controller/model/pose_error.h"

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

void write_tip(const CycleTrace& trace, controller_status_t* status) noexcept {
  write(trace.terms.X_BT, status->p_BT, status->quat_BT);
  write(trace.terms.V_BT, status->V_BT);
  write(trace.goal.X_BD, status->p_BD, status->quat_BD);
  write(pose_error(trace.terms.X_BT, trace.goal.X_BD, trace.gains.settings.orientation).e,
        status->e);
  write(trace.law.F, status->F_law);
}

void write_stiffness(const Gains& gains, controller_status_t* status) noexcept {
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) status->K_x[i][j] = static_cast<float>(gains.K_x(i, j));
  }
  write(gains.K_q.diagonal(), status->K_q);
}

void write_torque_terms(const CycleTrace& trace, controller_status_t* status) noexcept {
  write(trace.law.tau_stiffness + trace.law.tau_feedforward, status->tau_stiffness);
  write(trace.law.tau_damping, status->tau_damping);
  write(trace.tau_null, status->tau_null);
  write(trace.tau_gravity, status->tau_gravity);
  write(trace.tau_coriolis, status->tau_coriolis);
  write(trace.tau_friction, status->tau_friction);
  write(trace.tau_sent, status->tau_sent);
}

}  // namespace

void write_status(const CycleTrace& trace, controller_status_t* status) noexcept {
  status->law = static_cast<std::int8_t>(trace.selected_law);
  status->num_joints = static_cast<std::int8_t>(trace.point.q.size());
  status->limits = trace.limits;
  write_tip(trace, status);
  write_stiffness(trace.gains, status);
  write_torque_terms(trace, status);
  status->kinetic_energy_J = trace.terms.kinetic_energy(trace.point.v);
  status->spring_energy_J = trace.law.spring_energy_J;
  status->tank_energy_J = trace.tank_energy_J;
  status->passivity_energy_J = trace.passivity_energy_J;
  std::copy(trace.reports.begin(), trace.reports.end(), status->law_outputs);
  status->contact = static_cast<std::int8_t>(trace.settings.contact);
  write(trace.estimates.F_ext, status->F_ext);
  write(trace.estimates.tau_ext, status->tau_ext);
  for (std::size_t i = 0; i < kTerms; ++i) {
    status->term_period_cycles[i] = static_cast<std::int16_t>(trace.settings.period_cycles[i]);
  }
}

}  // namespace limber::controller
