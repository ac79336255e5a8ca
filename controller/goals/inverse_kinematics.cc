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

InverseKinematics::InverseKinematics(const LoadedRobot& robot)
    : model_(robot),
      terms_(model_.size()),
      q_(VectorJ::Zero(model_.size())),
      drift_(VectorJ::Zero(model_.size())) {}

void InverseKinematics::reset(const VectorJ& q) noexcept {
  q_ = q;
  drift_.setZero();
}

double InverseKinematics::step(const TaskRows& rows, const Pose& X_BD) noexcept {
  model_.evaluate_statics(q_, &terms_);
  const PoseError error = pose_error(terms_.X_BT, X_BD, Orientation::kLog);
  const Matrix6J J = rows.of(Matrix6J(error.A * terms_.J));
  const VectorJ way = damped_pseudo_inverse(J) * error.e;
  double longest = 0.0;
  for (const double part : way) longest = std::max(longest, std::abs(part));
  if (way.allFinite()) q_ -= std::min(1.0, kLongestStep_rad / longest) * way;
  return longest;
}

void InverseKinematics::correct(int steps, const TaskRows& rows, const Pose& X_BD) noexcept {
  for (int i = 0; i < steps; ++i) {
    if (step(rows, X_BD) < kConverged_rad) return;
  }
}

void InverseKinematics::approach(const TaskRows& rows, const Pose& X_BD) noexcept {
  correct(kStepsToApproach, rows, X_BD);
}

void InverseKinematics::track(const TaskRows& rows, double dt_s, Goal* goal) noexcept {
  q_ += dt_s * drift_;
  correct(kStepsPerCycle, rows, goal->X_BD);
  const Matrix6J J = rows.of(model_.jacobian(q_));
  const MatrixJ6 inverse = damped_pseudo_inverse(J);
  const VectorJ posture = kPostureRate_per_s * (goal->q_null - q_);
  drift_ = posture - inverse * (J * posture);

  goal->q_d = q_;
  goal->v_d = inverse * goal->V_BD + drift_;
  model_.evaluate(q_, goal->v_d, {.jacobian = true, .inertia = false, .coriolis = false}, &terms_);
  goal->a_d = inverse * (goal->A_BD - terms_.Jdot_v);
}

}  // namespace limber::controller
