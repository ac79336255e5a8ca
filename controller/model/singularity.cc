#include "controller/model/singularity.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace limber::controller {

TipMobility tip_mobility(const Matrix6J& J, const MatrixJ6& Minv_JT) noexcept {
  TipMobility mobility;
  mobility.S << Eigen::Vector3d::Ones(), Eigen::Vector3d::Constant(kRotationLength_m);
  Matrix6 G = mobility.S.asDiagonal() * (J * Minv_JT) * mobility.S.asDiagonal();
  G = (0.5 * (G + G.transpose())).eval();
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(G);
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
