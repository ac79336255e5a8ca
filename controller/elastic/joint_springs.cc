#include "controller/elastic/joint_springs.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "controller/elastic/spring_law.h"

namespace limber::controller {
namespace {

// Below it the secant is the tangent.
constexpr double kNoDeflection_rad = 1e-6;

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

const char* JointSprings::check(const MatrixJ& K_q, const VectorJ& K_J) const noexcept {
  for (Eigen::Index i = 0; i < K_J.size(); ++i) {
    if (!(K_q(i, i) <= kHighestShare * K_J[i])) {
      return "K_q must be at most 0.9 times the stiffness of each joint's spring: the link cannot "
             "be made stiffer than its spring (position_feedback: motor takes more, in series with "
             "it)";
    }
  }
  return nullptr;
}

MatrixJ JointSprings::within(const MatrixJ& K_q, const VectorJ& K_J) const noexcept {
  MatrixJ K = K_q;
  K.diagonal() = K.diagonal().cwiseMin(kHighestShare * K_J);
  return K;
}

double JointSprings::allowed_share(const Matrix6& K_x, const Matrix6J& J,
                                   const VectorJ& K_J) noexcept {
  const Matrix6J bent = J * K_J.cwiseSqrt().cwiseInverse().asDiagonal();
  const MatrixJ taken = bent.transpose() * K_x * bent;
  const Eigen::SelfAdjointEigenSolver<MatrixJ> eigen(taken, Eigen::EigenvaluesOnly);
  return kHighestShare / std::max(eigen.eigenvalues().maxCoeff(), kHighestShare);
}

const char* JointSprings::check(const Matrix6& K_x, const Matrix6J& J,
                                const VectorJ& K_J) const noexcept {
  if (!any_ || !(allowed_share(K_x, J, K_J) < 1.0)) return nullptr;
  return "K_x takes more than 0.9 times the stiffness of the joints' springs in this pose: the tip "
         "cannot be made stiffer than they are (position_feedback: motor takes more, in series "
         "with them)";
}

}  // namespace limber::controller
