#include "controller/elastic/joint_springs.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "controller/elastic/spring_law.h"

namespace limber::controller {
namespace {

// Below it the secant is the tangent.
constexpr double kNoDeflection_rad = 1e-6;
// Of a spring, where the weight takes all of it: no law can help, and none shall let go at once.
constexpr double kLeastBesideWeight = 0.05;

}  // namespace

JointSprings::JointSprings(const Robot& robot) : at_rest_(robot.size()) {
  for (const JointConfig& joint : robot.joints) {
    const TransmissionConfig& transmission = joint.transmission;
    joints_.push_back({transmission.kind, transmission.spring, transmission.preload_rad});
    any_ = any_ || !joint.rigid();
    at_rest_[static_cast<Eigen::Index>(joints_.size()) - 1] =
        stiffness_of(joints_.back(), 0.0, transmission.preload_rad);
  }
}

double JointSprings::stiffness_of(const OneJoint& joint, double d, double preload) noexcept {
  if (joint.kind == TransmissionKind::kRigid) return kRigid_Nm_per_rad;
  const bool relaxed = std::abs(d) < kNoDeflection_rad;
  double K = 0.0;
  if (joint.kind == TransmissionKind::kElastic) {
    K = relaxed ? spring_stiffness(joint.spring, d) : spring_torque(joint.spring, d) / d;
  } else {
    const SpringPair pair{joint.spring};
    K = relaxed ? pair.stiffness(preload, d) : pair.torque(preload, d) / d;
  }
  return std::max(K, kLeast_Nm_per_rad);
}

VectorJ JointSprings::stiffness(const VectorJ& d, const VectorJ& preload) const noexcept {
  VectorJ K(d.size());
  for (Eigen::Index i = 0; i < d.size(); ++i) {
    K[i] = stiffness_of(joints_[static_cast<std::size_t>(i)], d[i], preload[i]);
  }
  return K;
}

VectorJ JointSprings::torque(const VectorJ& d, const VectorJ& preload) const noexcept {
  VectorJ tau = stiffness(d, preload).cwiseProduct(d);
  for (Eigen::Index i = 0; i < d.size(); ++i)
    if (joints_[static_cast<std::size_t>(i)].kind == TransmissionKind::kRigid) tau[i] = 0.0;
  return tau;
}

// With c = K_J^-1/2 and the weight's eigenvalues w < 0 along V, the most is 1 along V c of
//   c (0.9 K_J + V min(w, 0) V^T) c.
double JointSprings::taken(const MatrixJ& K, const VectorJ& K_J, const MatrixJ& dg_dq,
                           Eigen::Index* most) noexcept {
  const auto c = K_J.cwiseSqrt().cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixJ> weight(MatrixJ(c * dg_dq * c));
  const VectorJ left =
      (kHighestShare + weight.eigenvalues().array().min(0.0)).max(kLeastBesideWeight);
  const MatrixJ bent = c * weight.eigenvectors() * left.cwiseSqrt().cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixJ> eigen(MatrixJ(bent.transpose() * K * bent));
  if (most != nullptr) {
    const VectorJ motion = bent * eigen.eigenvectors().rightCols<1>();
    (K * motion).cwiseProduct(motion).cwiseAbs().maxCoeff(most);
  }
  return eigen.eigenvalues().maxCoeff();
}

double JointSprings::allowed_share(const MatrixJ& K, const VectorJ& K_J,
                                   const MatrixJ& dg_dq) noexcept {
  const auto c = K_J.cwiseSqrt().cwiseInverse().asDiagonal();
  // Far from the bound, which is most of the time, the eigenvalues need not be known.
  if (MatrixJ(c * K * c).trace() + MatrixJ(c * dg_dq * c).norm() <= kHighestShare) return 1.0;
  return 1.0 / std::max(taken(K, K_J, dg_dq), 1.0);
}

MatrixJ JointSprings::within(const MatrixJ& K_q, const VectorJ& K_J,
                             const MatrixJ& dg_dq) noexcept {
  MatrixJ K = K_q;
  K.diagonal() = K.diagonal().cwiseMin(kHighestShare * K_J);
  return allowed_share(K, K_J, dg_dq) * K;
}

}  // namespace limber::controller
