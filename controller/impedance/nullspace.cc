#include "controller/impedance/nullspace.h"

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

TipInertia task_tip(const ArmTerms& terms, const TaskRows& rows) noexcept {
  if (rows.count() == 6 && terms.tip.least_share > 0.0) return terms.tip;
  return TipInertia(on_task(rows, terms.tip.G));
}

TipMobility task_mobility(const ArmTerms& terms, const TaskRows& rows) noexcept {
  return tip_mobility(on_task(rows, terms.tip.G));
}

Vector6 TaskRows::of(Vector6 F) const noexcept {
  for (int i = 0; i < 6; ++i) {
    if (!stiff[i]) F[i] = 0.0;
  }
  return F;
}

Matrix6 task_inertia(const ArmTerms& terms, const TaskRows& rows, double lost_share) noexcept {
  return damped_tip_inertia(task_tip(terms, rows), lost_share);
}

namespace {

// N X.
template <typename Matrix>
Matrix projected(const ArmTerms& terms, const TaskRows& rows, Projector projector,
                 double lost_share, const Matrix& X) noexcept {
  if (projector == Projector::kNone) return X;
  const bool dynamic = projector == Projector::kDynamic;
  const MatrixJ6 JT = terms.J.transpose();
  const MatrixJ6& Minv_JT = dynamic ? terms.Minv_JT : JT;  // of unit inertia
  const TipInertia tip =
      dynamic ? task_tip(terms, rows) : TipInertia(on_task(rows, terms.J.lazyProduct(JT)));
  const Matrix6 inertia = on_task(rows, damped_tip_inertia(tip, lost_share));
  return X - JT * (inertia * (Minv_JT.transpose() * X));
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
