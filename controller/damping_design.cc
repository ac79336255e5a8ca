#include "controller/damping_design.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace limber::controller {
namespace {

// Share of the greatest eigenvalue below which the tip cannot be said to move.
constexpr double kOutOfReach = 1e-9;
constexpr double kFloorLinear = 5.0;    // N s/m
constexpr double kFloorAngular = 0.2;   // N m s/rad
constexpr double kFloorFadesAt = 10.0;  // N/m
constexpr double kJointFloorTime_s = 0.5;
constexpr double kJointFloorFadesAt = 1.0;  // N m/rad

// 1 without stiffness, 0 from `end` on, smooth between.
double fade(double stiffness, double end) noexcept {
  const double left = std::max(1.0 - std::max(stiffness, 0.0) / end, 0.0);
  return left * left;
}

}  // namespace

MatrixJ joint_damping(const MatrixJ& M, const VectorJ& K, double ratio) noexcept {
  const Eigen::LLT<MatrixJ> cholesky(M);
  // S = A A^T with A = L^-1 sqrt(K)
  MatrixJ A = K.cwiseSqrt().asDiagonal().toDenseMatrix();
  cholesky.matrixL().solveInPlace(A);
  const MatrixJ S = A * A.transpose();
  const Eigen::SelfAdjointEigenSolver<MatrixJ> eigen(S);
  const MatrixJ LU = cholesky.matrixL() * eigen.eigenvectors();
  const VectorJ modal = 2.0 * ratio * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  return LU * modal.asDiagonal() * LU.transpose();
}

Matrix6 tip_damping(const TipMobility& mobility, const Matrix6& K, double ratio) noexcept {
  const double threshold = mobility.threshold(kOutOfReach);
  const Vector6 root = mobility.s.cwiseSqrt();
  const Vector6 inverse_root = root.cwiseQuotient(mobility.s.cwiseMax(threshold));
  const Matrix6 L = mobility.S.cwiseInverse().asDiagonal() * mobility.U * root.asDiagonal();
  const Matrix6 S = L.transpose() * K * L;
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(0.5 * (S + S.transpose()));
  const Matrix6 Q =
      mobility.S.asDiagonal() * mobility.U * inverse_root.asDiagonal() * eigen.eigenvectors();
  const Vector6 modal = 2.0 * ratio * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  return Q * modal.asDiagonal() * Q.transpose();
}

Matrix6 tip_damping_floor(const Matrix6& K) noexcept {
  Vector6 scale;
  scale << Eigen::Vector3d::Ones(), Eigen::Vector3d::Constant(1.0 / kRotationLength_m);
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(scale.asDiagonal() * K * scale.asDiagonal());
  Vector6 root_floor;
  root_floor << Eigen::Vector3d::Constant(std::sqrt(kFloorLinear)),
      Eigen::Vector3d::Constant(std::sqrt(kFloorAngular));
  const Matrix6 directions = root_floor.asDiagonal() * eigen.eigenvectors();
  const Vector6 weight = eigen.eigenvalues().unaryExpr(
      [](double stiffness) { return fade(stiffness, kFloorFadesAt); });
  return directions * weight.asDiagonal() * directions.transpose();
}

VectorJ joint_damping_floor(const MatrixJ& M, const VectorJ& K) noexcept {
  VectorJ floor = VectorJ::Zero(K.size());
  for (Eigen::Index i = 0; i < K.size(); ++i) {
    floor[i] = fade(K[i], kJointFloorFadesAt) * M(i, i) / kJointFloorTime_s;
  }
  return floor;
}

}  // namespace limber::controller
