#include "controller/model/singularity.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "dynamics/spd_solve.h"

namespace limber::controller {

Vector6 row_scale() noexcept {
  return (Vector6() << Eigen::Vector3d::Ones(), Eigen::Vector3d::Constant(kRotationLength_m))
      .finished();
}

// |G^-1| is at least 1 over the least eigenvalue, whatever norm.
std::optional<Matrix6> regular_inverse(const Matrix6& G, double least) noexcept {
  const Matrix6 inverse = dynamics::inverse_spd(G);  // not finite where G is not positive definite
  if (!(least * inverse.norm() <= 1.0)) return std::nullopt;
  return inverse;
}

Matrix6 scaled_mobility(const Matrix6& G) noexcept {
  const Vector6 S = row_scale();
  return S.asDiagonal() * G * S.asDiagonal();
}

// As in regular_inverse().
TipInertia::TipInertia(const Matrix6& inverse_inertia) noexcept
    : G(inverse_inertia), Lambda(dynamics::inverse_spd(G)) {
  const Vector6 S = row_scale();
  const Vector6 inverse = S.cwiseInverse();
  least_share = 1.0 / (G.cwiseProduct(S * S.transpose()).norm() *
                       Lambda.cwiseProduct(inverse * inverse.transpose()).norm());
}

TipMobility tip_mobility(const Matrix6& G) noexcept {
  TipMobility mobility;
  mobility.S = row_scale();
  const Matrix6 scaled = scaled_mobility(G);
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(scaled);
  mobility.U = eigen.eigenvectors();
  mobility.s = eigen.eigenvalues().cwiseMax(0.0);
  return mobility;
}

Matrix6 damped_tip_inertia(const TipMobility& mobility, double threshold) noexcept {
  Vector6 inverse;
  for (int i = 0; i < 6; ++i) {
    const double s = mobility.s[i];
    const double x = s / threshold;
    inverse[i] = x >= 1.0 ? 1.0 / s : x * (3.0 - 2.0 * x) / threshold;
  }
  const Matrix6 scaled = mobility.S.asDiagonal() * mobility.U;
  return scaled * inverse.asDiagonal() * scaled.transpose();
}

Matrix6 damped_tip_inertia(const TipInertia& tip, double lost_share) noexcept {
  if (tip.regular(lost_share)) return tip.Lambda;
  const TipMobility mobility = tip_mobility(tip.G);
  if (!(mobility.s[5] > 0.0)) return Matrix6::Zero();
  return damped_tip_inertia(mobility, mobility.threshold(lost_share));
}

MatrixJ6 damped_pseudo_inverse(const Matrix6J& J) noexcept {
  const Matrix6 G = J.lazyProduct(J.transpose());
  if (const auto inverse = regular_inverse(G, kSigma_0 * kSigma_0)) return J.transpose() * *inverse;
  return damped_inverse(J).inverse;
}

DampedInverse damped_inverse(const Matrix6J& J, double sigma_0, double lambda_max) noexcept {
  const Matrix6 G = J * J.transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(G);
  int rows = 0;
  for (int i = 0; i < 6; ++i) rows += J.row(i).isZero(0.0) ? 0 : 1;
  const int rank = std::min(rows, static_cast<int>(J.cols()));
  const Vector6 s = eigen.eigenvalues().cwiseMax(0.0);

  DampedInverse result{0.0, 0.0, J.transpose()};
  if (rank == 0) return result;
  result.sigma_min = std::sqrt(s[6 - rank]);
  const double x = result.sigma_min / sigma_0;
  if (x < 1.0) result.lambda = lambda_max * std::sqrt(1.0 - x * x);
  Vector6 inverse = Vector6::Zero();
  for (int i = 6 - rank; i < 6; ++i) {
    const double denominator = s[i] + result.lambda * result.lambda;
    if (denominator > 0.0) inverse[i] = 1.0 / denominator;
  }
  const Matrix6& U = eigen.eigenvectors();
  result.inverse = J.transpose() * (U * inverse.asDiagonal() * U.transpose());
  return result;
}

}  // namespace limber::controller
