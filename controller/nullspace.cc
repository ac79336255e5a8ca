#include "controller/nullspace.h"

namespace limber::controller {
namespace {

// Directions whose apparent inertia is more than ten thousand times the lightest one's are being
// lost.
constexpr double kLostShare = 1e-4;

}  // namespace

TaskRows::TaskRows(const Matrix6& K_x) noexcept {
  for (int i = 0; i < 6; ++i) stiff[i] = K_x.row(i).cwiseAbs().maxCoeff() > 0.0;
}

VectorJ project_to_null_space(const ArmTerms& terms, const TaskRows& rows,
                              const VectorJ& tau_0) noexcept {
  Matrix6J J = terms.J;
  MatrixJ6 Minv_JT = terms.Minv_JT;
  for (int i = 0; i < 6; ++i) {
    if (rows.stiff[i]) continue;
    J.row(i).setZero();
    Minv_JT.col(i).setZero();
  }
  const TipMobility mobility = tip_mobility(J, Minv_JT);
  if (!(mobility.s[5] > 0.0)) return tau_0;  // no task
  const Matrix6 inertia = damped_tip_inertia(mobility, mobility.threshold(kLostShare));
  const Vector6 F = inertia * (Minv_JT.transpose() * tau_0);
  return tau_0 - J.transpose() * F;
}

VectorJ null_space_torque(const ArmState& state, const ArmTerms& terms, const Goal& goal,
                          const Gains& gains, const TaskRows& rows,
                          const VectorJ& torque_limit) noexcept {
  VectorJ tau_0 =
      -gains.K_null.cwiseProduct(state.q - goal.q_null) - gains.D_null.cwiseProduct(state.v);
  tau_0 = tau_0.cwiseMax(-torque_limit).cwiseMin(torque_limit);
  return project_to_null_space(terms, rows, tau_0);
}

}  // namespace limber::controller
