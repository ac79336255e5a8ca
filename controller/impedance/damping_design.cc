#include "controller/impedance/damping_design.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

#include "dynamics/geometric_mean.h"

namespace limber::controller {
namespace {

// Share of the greatest eigenvalue below which the tip cannot be said to move.
constexpr double kOutOfReach = 1e-9;
constexpr double kRegular = 1e-6;  // above it a Cholesky decomposition will do
constexpr double kInertiaRounding = 1e-12;
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

template <typename Matrix>
Matrix root(const Matrix& K) noexcept {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(Matrix(0.5 * (K + K.transpose())));
  const Matrix& V = eigen.eigenvectors();
  return V * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() * V.transpose();
}

template <typename Matrix>
Matrix factorised(const Matrix& M, const Matrix& K, double ratio) noexcept {
  const Matrix product = root(M) * root(K);
  return ratio * (product + product.transpose());
}

// The sum of products of positive matrices need not be positive: what would drive is cut off.
template <typename Matrix>
Matrix never_driving(const Matrix& D) noexcept {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(D);
  const Matrix& V = eigen.eigenvectors();
  return V * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() * V.transpose();
}

// M = L L^T with L lower triangular, S = L^-1 K L^-T, D = 2 ratio L sqrt(S) L^T: twice the ratio
// times the geometric mean of M and K, which is found sooner without the modes unless a load has
// made K no spring in some direction.
template <typename Matrix>
Matrix doubly_diagonalised(const Matrix& M, const Matrix& K, double ratio) noexcept {
  Matrix mean(K.rows(), K.cols());
  if (dynamics::geometric_mean(M, K, mean)) return 2.0 * ratio * mean;
  // Where a direction is lost M has an eigenvalue of zero, or less by rounding.
  const Matrix least = kInertiaRounding * M.trace() * Matrix::Identity(M.rows(), M.cols());
  const Eigen::LLT<Matrix> cholesky(Matrix(M + least));
  Matrix S = K;
  cholesky.matrixL().solveInPlace(S);
  S.transposeInPlace();
  cholesky.matrixL().solveInPlace(S);
  const Matrix L = cholesky.matrixL();
  return 2.0 * ratio * L * root(S) * L.transpose();
}

template <typename Matrix>
Matrix designed(DampingDesign design, const Matrix& M, const Matrix& K, double ratio) noexcept {
  switch (design) {
    case DampingDesign::kDoubleDiagonalisation:
      return doubly_diagonalised<Matrix>(M, K, ratio);
    case DampingDesign::kFactorisation:
      return never_driving<Matrix>(factorised<Matrix>(M, K, ratio));
    case DampingDesign::kWithoutInertia:
      return 2.0 * ratio * root<Matrix>(K);
    case DampingDesign::kGiven:
      break;
  }
  return Matrix::Zero(K.rows(), K.cols());
}

// L with G = L L^T over the directions within reach, and its pseudo-inverse transposed.
struct Reach {
  explicit Reach(const TipMobility& mobility) noexcept {
    const Vector6 root = mobility.s.cwiseSqrt();
    const Vector6 inverse =
        root.cwiseQuotient(mobility.s.cwiseMax(mobility.threshold(kOutOfReach)));
    L = mobility.S.cwiseInverse().asDiagonal() * mobility.U * root.asDiagonal();
    inverse_transpose = mobility.S.asDiagonal() * mobility.U * inverse.asDiagonal();
  }
  /// From the Cholesky factor; only for |G| |G^-1| up to 1 / kRegular, else empty.
  static std::optional<Reach> regular(const Matrix6& mobility) noexcept {
    const Matrix6 G = scaled_mobility(mobility);
    const Eigen::LLT<Matrix6> cholesky(G);
    if (cholesky.info() != Eigen::Success) return std::nullopt;
    Matrix6 inverse = Matrix6::Identity();
    cholesky.matrixL().solveInPlace(inverse);
    // The trace of G^-1: at least 1 over the least eigenvalue.
    if (!(kRegular * G.norm() * inverse.squaredNorm() <= 1.0)) return std::nullopt;
    const Vector6 S = row_scale();
    return Reach(S.cwiseInverse().asDiagonal() * Matrix6(cholesky.matrixL()),
                 S.asDiagonal() * inverse.transpose());
  }
  Matrix6 damping(const Matrix6& K, double ratio) const noexcept {
    return 2.0 * ratio * inverse_transpose * root<Matrix6>(L.transpose() * K * L) *
           inverse_transpose.transpose();
  }
  /// Of the modes, symmetric.
  Matrix6 stiffness(const Matrix6& K) const noexcept {
    const Matrix6 S = L.transpose() * K * L;
    return 0.5 * (S + S.transpose());
  }
  Matrix6 L;
  Matrix6 inverse_transpose;

 private:
  Reach(const Matrix6& factor, const Matrix6& its_inverse_transpose) noexcept
      : L(factor), inverse_transpose(its_inverse_transpose) {}
};

}  // namespace

MatrixJ joint_damping(DampingDesign design, const MatrixJ& M, const MatrixJ& K,
                      double ratio) noexcept {
  return designed<MatrixJ>(design, M, K, ratio);
}

Matrix6 inertia_damping(DampingDesign design, const Matrix6& M_d, const Matrix6& K,
                        double ratio) noexcept {
  return designed<Matrix6>(design, M_d, K, ratio);
}

Matrix6 factorised_tip_damping(const TipMobility& mobility, const Matrix6& K,
                               double ratio) noexcept {
  const Matrix6 Lambda = damped_tip_inertia(mobility, mobility.threshold(kOutOfReach));
  return factorised<Matrix6>(Lambda, K, ratio);
}

Matrix6 tip_damping(DampingDesign design, const TipMobility& mobility, const Matrix6& K,
                    double ratio) noexcept {
  switch (design) {
    case DampingDesign::kDoubleDiagonalisation:
      return Reach(mobility).damping(K, ratio);
    case DampingDesign::kFactorisation:
      return never_driving<Matrix6>(factorised_tip_damping(mobility, K, ratio));
    case DampingDesign::kWithoutInertia:
      return 2.0 * ratio * root<Matrix6>(K);
    case DampingDesign::kGiven:
      break;
  }
  return Matrix6::Zero();
}

Matrix6 tip_damping(DampingDesign design, const TipInertia& tip, const Matrix6& K,
                    double ratio) noexcept {
  if (design == DampingDesign::kDoubleDiagonalisation && tip.regular(kRegular))
    return doubly_diagonalised<Matrix6>(tip.Lambda, K, ratio);
  return tip_damping(design, tip_mobility(tip.G), K, ratio);
}

TipModes tip_modes_of(const Matrix6& G, const Matrix6& K) noexcept {
  std::optional<Reach> reach = Reach::regular(G);
  if (!reach) reach.emplace(tip_mobility(G));
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(reach->stiffness(K));
  return {eigen.eigenvalues().cwiseMax(0.0), reach->inverse_transpose * eigen.eigenvectors()};
}

Vector6 modal_stiffness(const TipMobility& mobility, const Matrix6& K) noexcept {
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(Reach(mobility).stiffness(K),
                                                     Eigen::EigenvaluesOnly);
  return eigen.eigenvalues().cwiseMax(0.0);
}

Matrix6 tip_damping_floor(const Matrix6& K) noexcept {
  Vector6 scale;
  scale << Eigen::Vector3d::Ones(), Eigen::Vector3d::Constant(1.0 / kRotationLength_m);
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(
      Matrix6(scale.asDiagonal() * K * scale.asDiagonal()));
  Vector6 root_floor;
  root_floor << Eigen::Vector3d::Constant(std::sqrt(kFloorLinear)),
      Eigen::Vector3d::Constant(std::sqrt(kFloorAngular));
  const Matrix6 directions = root_floor.asDiagonal() * eigen.eigenvectors();
  const Vector6 weight = eigen.eigenvalues().unaryExpr(
      [](double stiffness) { return fade(stiffness, kFloorFadesAt); });
  return directions * weight.asDiagonal() * directions.transpose();
}

VectorJ joint_damping_floor(const MatrixJ& M, const MatrixJ& K) noexcept {
  VectorJ floor = VectorJ::Zero(K.rows());
  for (Eigen::Index i = 0; i < K.rows(); ++i) {
    floor[i] = fade(K(i, i), kJointFloorFadesAt) * M(i, i) / kJointFloorTime_s;
  }
  return floor;
}

}  // namespace limber::controller
