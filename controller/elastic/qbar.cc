#include "controller/elastic/qbar.h"

#include <Eigen/Cholesky>

namespace limber::controller {
namespace {

constexpr double kStep = 1e-5;        // rad, for differences
constexpr double kContraction = 0.7;  // slower than this, Newton steps are cheaper

}  // namespace

QbarSolver::QbarSolver(ArmModel* model, const VectorJ& K_J, const Options& options)
    : model_(model),
      K_J_(K_J),
      options_(options),
      tau_constant_(VectorJ::Zero(model->size())),
      terms_(model->size()),
      q_(VectorJ::Zero(model->size())),
      l_(q_) {}

VectorJ QbarSolver::law(const VectorJ& q, const TipSpring& spring) noexcept {
  model_->evaluate_statics(q, &terms_);
  const PoseError error = pose_error(terms_.X_BT, spring.X_BD, spring.orientation);
  const Vector6 Ke = spring.K_x * error.e;
  const double scale = spring.limit.apply(0.5 * error.e.dot(Ke)).scale;
  const Vector6 F = spring.F_ff - scale * (error.A.transpose() * Ke);
  return fixed_part() + terms_.J.transpose() * F;
}

VectorJ QbarSolver::law(const VectorJ& q, const JointSpring& spring) noexcept {
  model_->evaluate_statics(q, &terms_);
  return fixed_part() - spring.K_d * (q - spring.q_d);
}

bool QbarSolver::solve(const VectorJ& theta, const TipSpring& spring) noexcept {
  return solve_for(theta, spring);
}

bool QbarSolver::solve(const VectorJ& theta, const JointSpring& spring) noexcept {
  return solve_for(theta, spring);
}

template <typename Spring>
bool QbarSolver::solve_for(const VectorJ& theta, const Spring& spring) noexcept {
  iterations_ = 0;
  if (!theta.allFinite()) return false;
  if (!warm_) q_ = theta;
  warm_ = fixpoint(theta, spring);
  if (!warm_ && options_.newton) {
    q_ = theta;
    warm_ = newton(theta, spring);
  }
  if (!warm_) q_ = theta;
  l_ = law(q_, spring);
  return warm_;
}

// True: converged. False: it does not contract, or not fast enough.
template <typename Spring>
bool QbarSolver::fixpoint(const VectorJ& theta, const Spring& spring) noexcept {
  double before = 0.0;
  for (int i = 0; i < options_.max_iterations; ++i) {
    const VectorJ next = theta - law(q_, spring).cwiseQuotient(K_J_);
    const double change = (next - q_).cwiseAbs().maxCoeff();
    q_ = next;
    ++iterations_;
    if (change <= options_.tolerance) return true;
    if (!next.allFinite()) return false;
    const bool slow = change > (options_.newton ? kContraction : 1.0) * before;
    // The first changes say little about the last ones.
    if (i > 2 && slow) return false;
    before = change;
  }
  return false;
}

template <typename Spring>
bool QbarSolver::newton(const VectorJ& theta, const Spring& spring) noexcept {
  for (int i = 0; i < options_.max_newton_steps; ++i) {
    const VectorJ residual = K_J_.cwiseProduct(q_ - theta) + law(q_, spring);
    const MatrixJ slope = tangent(q_, spring);
    if (!stable(slope)) return false;
    const MatrixJ S = slope + MatrixJ(K_J_.asDiagonal());
    const VectorJ step = S.llt().solve(residual);
    q_ -= step;
    ++iterations_;
    if (!q_.allFinite()) return false;
    if (step.cwiseAbs().maxCoeff() <= options_.tolerance) return stable(tangent(q_, spring));
  }
  return false;
}

// On all of the way from the motor's position: a solution beyond a limb that buckles is another
// one.
bool QbarSolver::stable(const MatrixJ& slope) const noexcept {
  const VectorJ left = (1.0 - kLeastShare) * K_J_;
  return MatrixJ(slope + MatrixJ(left.asDiagonal())).llt().info() == Eigen::Success;
}

template <typename Spring>
MatrixJ QbarSolver::tangent(const VectorJ& q, const Spring& spring) noexcept {
  const Eigen::Index n = q.size();
  MatrixJ slope(n, n);
  VectorJ at = q;
  for (Eigen::Index i = 0; i < n; ++i) {
    at[i] = q[i] + kStep;
    slope.col(i) = law(at, spring);
    at[i] = q[i] - kStep;
    slope.col(i) -= law(at, spring);
    at[i] = q[i];
  }
  slope /= 2.0 * kStep;
  return 0.5 * (slope + slope.transpose());
}

}  // namespace limber::controller
