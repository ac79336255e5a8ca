#include "controller/impedance/elastic_design.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "controller/impedance/damping_design.h"
#include "controller/impedance/elastic_damping.h"

namespace limber::controller {
namespace {

constexpr double kCyclesLate = 1.5;
constexpr double kShareOfStable = 0.5;
constexpr double kLeastInertia = 1e-6;

double most_damping(const JointElasticity& joints) noexcept {
  return joints.period_s > 0.0 ? kShareOfStable / joints.period_s
                               : std::numeric_limits<double>::infinity();
}

// u: motion of the joints, p: their torque for a unit of force, n each; k: of u, 1/s^2.
double mode_damping(const JointElasticity& joints, const VectorJ& B, const VectorJ& u,
                    const VectorJ& p, double k, double ratio, ElasticDesign* design) noexcept {
  const VectorJ bend = p.cwiseQuotient(joints.K_J);
  const double compliance = p.dot(bend);
  const double spring = 1.0 / std::max(compliance, 1e-300);
  const double rotor = std::clamp(u.dot(B.cwiseProduct(u)), kLeastInertia, 1.0 - kLeastInertia);
  const ElasticMode mode = {.link = 1.0 - rotor,
                            .rotor = rotor,
                            .spring = spring,
                            .damper = bend.dot(joints.D_J.cwiseProduct(bend)) * spring * spring,
                            .law = law_stiffness(joints.position, k, compliance),
                            .at_link = joints.position == PositionFeedback::kLink};
  const double t_d = kCyclesLate * joints.period_s;
  const double most = most_damping(joints) / p.dot(p.cwiseQuotient(B));
  const ElasticDamping found = elastic_damping(mode, ratio, 2.0 * ratio * std::sqrt(k), most, t_d);
  if (design != nullptr) {
    design->modes[design->count++] = {std::sqrt(k), found.ratio, motor_share(mode, found.D, t_d)};
  }
  return found.D;
}

// D without what exceeds the most that N^T D N may have; N: B^-1/2, at the tip J B^-1/2.
template <typename Matrix, typename Wide>
Matrix bounded(const Matrix& D, const Wide& N, double most) noexcept {
  const MatrixJ seen = N.transpose() * D * N;
  if (seen.trace() <= most) return D;
  const Eigen::SelfAdjointEigenSolver<MatrixJ> eigen(seen);
  Matrix left = D;
  for (Eigen::Index i = 0; i < seen.rows(); ++i) {
    const double value = eigen.eigenvalues()[i];
    if (!(value > most)) continue;
    const auto y = (D * N * eigen.eigenvectors().col(i) / value).eval();
    left -= (value - most) * y * y.transpose();
  }
  return left;
}

}  // namespace

double ElasticDesign::least_ratio() const noexcept {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < count; ++i) least = std::min(least, modes[i].ratio);
  return least;
}

MatrixJ elastic_joint_damping(const JointElasticity& joints, const ArmTerms& terms,
                              const MatrixJ& K, double ratio, ElasticDesign* design) noexcept {
  if (design != nullptr) *design = ElasticDesign();
  const Eigen::LLT<MatrixJ> cholesky(terms.M_total);
  MatrixJ S = K;
  cholesky.matrixL().solveInPlace(S);
  S.transposeInPlace();
  cholesky.matrixL().solveInPlace(S);
  const Eigen::SelfAdjointEigenSolver<MatrixJ> eigen(MatrixJ(0.5 * (S + S.transpose())));
  MatrixJ U = eigen.eigenvectors();
  cholesky.matrixU().solveInPlace(U);
  const MatrixJ L = cholesky.matrixL();
  const MatrixJ P = L * eigen.eigenvectors();
  const VectorJ& k = eigen.eigenvalues();
  VectorJ d = VectorJ::Zero(k.size());
  for (Eigen::Index i = 0; i < k.size(); ++i) {
    if (!(k[i] > kNoStiffness * k.maxCoeff())) continue;
    d[i] = mode_damping(joints, terms.B, U.col(i), P.col(i), k[i], ratio, design);
  }
  const MatrixJ D = P * d.asDiagonal() * P.transpose();
  const MatrixJ N = terms.B.cwiseSqrt().cwiseInverse().asDiagonal();
  return bounded<MatrixJ>(D, N, most_damping(joints));
}

Matrix6 elastic_tip_damping(const JointElasticity& joints, const ArmTerms& terms, const Matrix6& K,
                            double ratio, ElasticDesign* design) noexcept {
  if (design != nullptr) *design = ElasticDesign();
  const TipModes modes = tip_modes_of(terms.tip.G, K);
  const MatrixJ6 U = terms.Minv_JT * modes.force;
  const MatrixJ6 P = terms.J.transpose() * modes.force;
  Vector6 d = Vector6::Zero();
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (!(modes.stiffness[i] > kNoStiffness * modes.stiffness.maxCoeff())) continue;
    d[i] = mode_damping(joints, terms.B, U.col(i), P.col(i), modes.stiffness[i], ratio, design);
  }
  const Matrix6 D = modes.force * d.asDiagonal() * modes.force.transpose();
  const Matrix6J N = terms.J * terms.B.cwiseSqrt().cwiseInverse().asDiagonal();
  return bounded<Matrix6>(D, N, most_damping(joints));
}

ElasticDesign joint_design(const JointElasticity& joints, const ArmTerms& terms,
                           const Gains& gains) noexcept {
  ElasticDesign design;
  elastic_joint_damping(joints, terms, gains.K_q, gains.joint_damping_ratio, &design);
  return design;
}

ElasticDesign tip_design(const JointElasticity& joints, const ArmTerms& terms,
                         const Gains& gains) noexcept {
  ElasticDesign design;
  elastic_tip_damping(joints, terms, gains.K_x, gains.damping_ratio, &design);
  return design;
}

}  // namespace limber::controller
