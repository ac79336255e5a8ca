#include "controller/nullspace.h"

#include <algorithm>
#include <iterator>

namespace limber::controller {
TaskRows::TaskRows(const Matrix6& K_x) noexcept {
  for (int i = 0; i < 6; ++i) stiff[i] = K_x.row(i).cwiseAbs().maxCoeff() > 0.0;
}

int TaskRows::count() const noexcept {
  return static_cast<int>(std::count(std::begin(stiff), std::end(stiff), true));
}

Matrix6J TaskRows::of(Matrix6J J) const noexcept {
  for (int i = 0; i < 6; ++i) {
    if (!stiff[i]) J.row(i).setZero();
  }
  return J;
}

Matrix6 task_inertia(const ArmTerms& terms, const TaskRows& rows, double lost_share) noexcept {
  const MatrixJ6 Minv_JT = rows.of(terms.Minv_JT.transpose()).transpose();
  const TipMobility mobility = tip_mobility(rows.of(terms.J), Minv_JT);
  if (!(mobility.s[5] > 0.0)) return Matrix6::Zero();
  return damped_tip_inertia(mobility, mobility.threshold(lost_share));
}

MatrixJ null_space_projector(const ArmTerms& terms, const TaskRows& rows, Projector projector,
                             double lost_share) noexcept {
  const auto n = terms.J.cols();
  MatrixJ N = MatrixJ::Identity(n, n);
  if (projector == Projector::kNone) return N;
  const Matrix6J J = rows.of(terms.J);
  MatrixJ6 Minv_JT = J.transpose();  // unit inertia
  if (projector == Projector::kDynamic) Minv_JT = rows.of(terms.Minv_JT.transpose()).transpose();
  const TipMobility mobility = tip_mobility(J, Minv_JT);
  if (!(mobility.s[5] > 0.0)) return N;  // no task
  const Matrix6 inertia = damped_tip_inertia(mobility, mobility.threshold(lost_share));
  N.noalias() -= J.transpose() * (inertia * Minv_JT.transpose());
  return N;
}

VectorJ null_space_torque(const ArmState& state, const ArmTerms& terms, const Goal& goal,
                          const Gains& gains, const TaskRows& rows,
                          const VectorJ& torque_limit) noexcept {
  VectorJ tau_0 = -gains.K_null * (state.q - goal.q_null) - gains.D_null * state.v;
  tau_0 = tau_0.cwiseMax(-torque_limit).cwiseMin(torque_limit);
  const LawSettings& s = gains.settings;
  return null_space_projector(terms, rows, s.projector, s.lost_share) * tau_0;
}

}  // namespace limber::controller
