#include "controller/goals/inverse_kinematics.h"

#include <algorithm>
#include <cmath>

#include "controller/model/pose_error.h"
#include "controller/model/singularity.h"

namespace limber::controller {
namespace {

constexpr int kStepsPerCycle = 3;
constexpr int kStepsToApproach = 20;
constexpr double kLongestStep_rad = 0.1;
// After a step this small, the next would be one of rounding: Gauss-Newton squares what is left.
constexpr double kConverged_rad = 1e-9;
constexpr double kPostureRate_per_s = 1.0;

}  // namespace

InverseKinematics::InverseKinematics(const ArmModel& model)
    : model_(model), q_(VectorJ::Zero(model_.size())), drift_(VectorJ::Zero(model_.size())) {}

void InverseKinematics::reset(const VectorJ& q) noexcept {
  q_ = q;
  drift_.setZero();
}

InverseKinematics::Tangent InverseKinematics::correct(int steps, const TaskRows& rows,
                                                      const Pose& X_BD) noexcept {
  for (int i = 0; i < steps; ++i) {
    const ArmModel::Tip tip = model_.tip(q_);
    const PoseError error = pose_error(tip.X_BT, X_BD, Orientation::kLog);
    const MatrixJ6 inverse = damped_pseudo_inverse(rows.of(Matrix6J(error.A * tip.J)));
    const VectorJ way = inverse * error.e;
    double longest = 0.0;
    for (const double part : way) longest = std::max(longest, std::abs(part));
    if (way.allFinite()) q_ -= std::min(1.0, kLongestStep_rad / longest) * way;
    if (!(longest < kConverged_rad)) continue;
    if ((error.A - Matrix6::Identity()).norm() < kConverged_rad) return {rows.of(tip.J), inverse};
    break;
  }
  const Matrix6J J = rows.of(model_.jacobian(q_));
  return {J, damped_pseudo_inverse(J)};
}

void InverseKinematics::approach(const TaskRows& rows, const Pose& X_BD) noexcept {
  correct(kStepsToApproach, rows, X_BD);
}

void InverseKinematics::track(const TaskRows& rows, double dt_s, Goal* goal) noexcept {
  q_ += dt_s * drift_;
  const auto [J, inverse] = correct(kStepsPerCycle, rows, goal->X_BD);
  const VectorJ posture = kPostureRate_per_s * (goal->q_null - q_);
  drift_ = posture - inverse * (J * posture);

  goal->q_d = q_;
  goal->v_d = inverse * goal->V_BD + drift_;
  goal->a_d = inverse * (goal->A_BD - model_.jacobian_rate(q_, goal->v_d));
}

}  // namespace limber::controller
