#include "controller/gains/nullspace.h"

#include <Eigen/Cholesky>
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

MatrixJ6 TaskRows::of(MatrixJ6 Minv_JT) const noexcept {
  for (int i = 0; i < 6; ++i) {
    if (!stiff[i]) Minv_JT.col(i).setZero();
  }
  return Minv_JT;
}

Matrix6 on_task(const TaskRows& rows, Matrix6 M) noexcept {
  for (int i = 0; i < 6; ++i) {
    if (rows.stiff[i]) continue;
    M.row(i).setZero();
    M.col(i).setZero();
  }
  return M;
}

Matrix6 invertible_on_task(const TaskRows& rows, const Matrix6& M) noexcept {
  Matrix6 result = on_task(rows, M);
  for (int i = 0; i < 6; ++i) {
    if (result.row(i).isZero(0.0)) result(i, i) = 1.0;
  }
  return result;
}

const char* check_tip_inertia(const Gains& gains) noexcept {
  if (gains.M_x.isZero(0.0)) return nullptr;
  TaskRows rows(gains.K_x);
  if (gains.settings.frame == GainFrame::kGoal) {
    for (const int first : {0, 3}) {
      bool* block = rows.stiff + first;
      block[0] = block[1] = block[2] = block[0] || block[1] || block[2];
    }
  }
  bool positive = invertible_on_task(rows, gains.M_x).llt().info() == Eigen::Success;
  for (int i = 0; i < 6; ++i) positive = positive && (!rows.stiff[i] || gains.M_x(i, i) > 0.0);
  return positive ? nullptr
                  : "M_x must be positive definite in the rows in which K_x has entries (with "
                    "frame: goal, in the whole block)";
}

TipMobility task_mobility(const ArmTerms& terms, const TaskRows& rows) noexcept {
  return tip_mobility(rows.of(terms.J), rows.of(terms.Minv_JT));
}

Vector6 TaskRows::of(Vector6 F) const noexcept {
  for (int i = 0; i < 6; ++i) {
    if (!stiff[i]) F[i] = 0.0;
  }
  return F;
}

Matrix6 task_inertia(const ArmTerms& terms, const TaskRows& rows, double lost_share) noexcept {
  return damped_tip_inertia(rows.of(terms.J), rows.of(terms.Minv_JT), lost_share);
}

namespace {

// N X.
template <typename Matrix>
Matrix projected(const ArmTerms& terms, const TaskRows& rows, Projector projector,
                 double lost_share, const Matrix& X) noexcept {
  if (projector == Projector::kNone) return X;
  const Matrix6J J = rows.of(terms.J);
  MatrixJ6 Minv_JT = J.transpose();  // unit inertia
  if (projector == Projector::kDynamic) Minv_JT = rows.of(terms.Minv_JT);
  const Matrix6 inertia = damped_tip_inertia(J, Minv_JT, lost_share);
  return X - J.transpose() * (inertia * (Minv_JT.transpose() * X));
}

}  // namespace

MatrixJ null_space_projector(const ArmTerms& terms, const TaskRows& rows, Projector projector,
                             double lost_share) noexcept {
  const auto n = terms.J.cols();
  return projected<MatrixJ>(terms, rows, projector, lost_share, MatrixJ::Identity(n, n));
}

VectorJ null_space_torque(const ControlPoint& point, const ArmTerms& terms, const Goal& goal,
                          const Gains& gains, const TaskRows& rows,
                          const VectorJ& torque_limit) noexcept {
  VectorJ tau_0 = -gains.K_null * (point.q - goal.q_null) - gains.D_null * point.v;
  tau_0 = tau_0.cwiseMax(-torque_limit).cwiseMin(torque_limit);
  const LawSettings& s = gains.settings;
  return projected<VectorJ>(terms, rows, s.projector, s.lost_share, tau_0);
}

}  // namespace limber::controller
