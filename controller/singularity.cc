#include "controller/singularity.h"

#include <Eigen/Eigenvalues>

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

}  // namespace limber::controller
