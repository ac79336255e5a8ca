#include "controller/impedance/stiffness_mapping.h"

#include <algorithm>

#include "controller/model/pose_error.h"
#include "controller/model/rotation.h"

namespace limber::controller {
namespace {

// Of the order of the cube root of the rounding error: best for central differences.
constexpr double kDifference_rad = 6e-6;

bool has_potential(Orientation orientation) noexcept {
  return orientation != Orientation::kLogSimple && orientation != Orientation::kQuatSimple;
}

Vector6 holding_wrench(const Pose& X_BT, const Pose& X_BD, const Matrix6& K_x,
                       Orientation orientation) noexcept {
  const PoseError error = pose_error(X_BT, X_BD, orientation);
  return error.A.transpose() * (K_x * error.e);
}

}  // namespace

MatrixJ first_term(const Matrix6J& J, const PoseError& error, const Matrix6& K_x) noexcept {
  const Matrix6J AJ = error.A * J;
  return AJ.transpose() * K_x * AJ;
}

MatrixJ geometric_term(const Matrix6J& J, const Vector6& W) noexcept {
  const auto n = J.cols();
  const Eigen::Vector3d f = W.head<3>();
  const Eigen::Vector3d mu = W.tail<3>();
  const auto z = [&J](Eigen::Index i) -> Eigen::Vector3d { return J.col(i).tail<3>(); };
  MatrixJ K_G(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 0; k < n; ++k) {
      const Eigen::Vector3d J_v = J.col(std::max(i, k)).head<3>();
      K_G(i, k) = z(std::min(i, k)).cross(J_v).dot(f);
      if (k < i) K_G(i, k) += z(k).cross(z(i)).dot(mu);
    }
  }
  return K_G;
}

VectorJ holding_torque(ArmModel* model, const VectorJ& q, const Pose& X_BD, const Matrix6& K_x,
                       Orientation orientation) noexcept {
  const ArmModel::Tip tip = model->tip(q);
  return tip.J.transpose() * holding_wrench(tip.X_BT, X_BD, K_x, orientation);
}

MatrixJ full_tangent(ArmModel* model, const VectorJ& q, const Pose& X_BD, const Matrix6& K_x,
                     Orientation orientation) noexcept {
  const ArmModel::Tip tip = model->tip(q);
  const auto turned = [&](int axis, double angle) {
    const Eigen::Quaterniond turn = exp_rotation(angle * Eigen::Vector3d::Unit(axis));
    return holding_wrench({tip.X_BT.p, turn * tip.X_BT.Q}, X_BD, K_x, orientation);
  };
  Matrix6 slope;  // of W, by the tip's position and rotation
  slope.leftCols<3>() = pose_error(tip.X_BT, X_BD, orientation).A.transpose() * K_x.leftCols<3>();
  for (int axis = 0; axis < 3; ++axis) {
    slope.col(3 + axis) =
        (turned(axis, kDifference_rad) - turned(axis, -kDifference_rad)) / (2.0 * kDifference_rad);
  }
  const MatrixJ K_q = geometric_term(tip.J, holding_wrench(tip.X_BT, X_BD, K_x, orientation)) +
                      tip.J.transpose() * slope * tip.J;
  if (!has_potential(orientation)) return K_q;
  return 0.5 * (K_q + K_q.transpose());
}

MatrixJ joint_stiffness(StiffnessTerms terms, ArmModel* model, const VectorJ& q, const Pose& X_BD,
                        const Matrix6& K_x, Orientation orientation) noexcept {
  if (terms == StiffnessTerms::kFull) return full_tangent(model, q, X_BD, K_x, orientation);
  const auto [X_BT, J] = model->tip(q);
  const PoseError error = pose_error(X_BT, X_BD, orientation);
  MatrixJ K_q = first_term(J, error, K_x);
  if (terms == StiffnessTerms::kGeometric) {
    K_q += geometric_term(J, error.A.transpose() * (K_x * error.e));
  }
  return K_q;
}

DampingTangent damping_tangent(ArmModel* model, const VectorJ& q, const VectorJ& v,
                               const Matrix6& D_x) noexcept {
  const auto n = q.size();
  const Matrix6J J = model->jacobian(q);
  const Vector6 F = D_x * (J * v);
  DampingTangent tangent{MatrixJ(n, n), MatrixJ(n, n)};
  VectorJ at = q;
  for (Eigen::Index k = 0; k < n; ++k) {
    at[k] = q[k] + kDifference_rad;
    const Matrix6J above = model->jacobian(at);
    at[k] = q[k] - kDifference_rad;
    const Matrix6J dJ = (above - model->jacobian(at)) / (2.0 * kDifference_rad);
    at[k] = q[k];
    tangent.transpose_part.col(k) = dJ.transpose() * F;
    tangent.velocity_part.col(k) = J.transpose() * (D_x * (dJ * v));
  }
  return tangent;
}

MappedGains mapped_gains(ArmModel* model, const VectorJ& q, const VectorJ& v, const Goal& goal,
                         const Gains& gains, const Matrix6& D_x,
                         const MappingChoice& choice) noexcept {
  const LawSettings& s = gains.settings;
  const auto stiffness_at = [&](const VectorJ& pose) {
    return joint_stiffness(s.stiffness_terms, model, pose, goal.X_BD, gains.K_x, s.orientation);
  };
  const Matrix6J J = model->jacobian(q);
  MappedGains result{MatrixJ(), J.transpose() * D_x * J};
  switch (choice.pose) {
    case MappingPose::kCurrent:
      result.K_p = stiffness_at(q);
      break;
    case MappingPose::kGoal:
      result.K_p = stiffness_at(goal.q_d);
      break;
    case MappingPose::kMid:
      result.K_p = stiffness_at(0.5 * (q + goal.q_d));
      break;
    case MappingPose::kMean:
      result.K_p = 0.5 * (stiffness_at(q) + stiffness_at(goal.q_d));
      break;
  }
  if (choice.damping_partials == DampingPartials::kNone) return result;
  const DampingTangent tangent = damping_tangent(model, q, v, D_x);
  if (choice.damping_partials == DampingPartials::kPrinted) result.K_v += tangent.transpose_part;
  if (choice.damping_partials == DampingPartials::kInStiffness) {
    result.K_p += tangent.transpose_part + tangent.velocity_part;
  }
  return result;
}

}  // namespace limber::controller
