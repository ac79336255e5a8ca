#include "controller/gains.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "common/config_error.h"

namespace limber::controller {
namespace {

constexpr double kMaxLinearStiffness = 1e5;   // N/m
constexpr double kMaxAngularStiffness = 1e4;  // N m/rad, joints too
constexpr double kMaxNullDamping = 1e3;       // N m s/rad
constexpr double kMaxDampingRatio = 2.0;
constexpr double kMaxRamp_s = 60.0;
// What rounding may do to a matrix that was symmetric and positive semidefinite on paper.
constexpr double kRounding = 1e-9;

bool within(double x, double low, double high) noexcept { return x >= low && x <= high; }

bool all_within(const double* values, int count, double high) noexcept {
  return std::all_of(values, values + count, [high](double x) { return within(x, 0.0, high); });
}

Matrix6 stiffness_of(const compliance_gains_t& message) noexcept {
  Matrix6 K;
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) K(row, column) = message.K_x[row][column];
  }
  return K;
}

const char* refuse_stiffness(const Matrix6& K) noexcept {
  if (!K.allFinite()) return "K_x is not finite";
  for (int i = 0; i < 6; ++i) {
    const double limit = i < 3 ? kMaxLinearStiffness : kMaxAngularStiffness;
    if (!within(K(i, i), 0.0, limit)) {
      return "K_x: the diagonal must be within 0..1e5 N/m and 0..1e4 N m/rad";
    }
  }
  const double scale = K.cwiseAbs().maxCoeff();
  if (!((K - K.transpose()).cwiseAbs().maxCoeff() <= kRounding * scale)) {
    return "K_x is not symmetric";
  }
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(K, Eigen::EigenvaluesOnly);
  if (!(eigen.eigenvalues().minCoeff() >= -kRounding * scale)) {
    return "K_x is not positive semidefinite";
  }
  return nullptr;
}

VectorJ vector_of(const std::vector<double>& values, const Robot& robot, const char* key) {
  if (static_cast<int>(values.size()) != robot.size()) {
    throw ConfigError(robot.name + ": gains." + key + ": " + std::to_string(values.size()) +
                      " values; one for each of the " + std::to_string(robot.size()) +
                      " joints is needed");
  }
  return Eigen::Map<const Eigen::VectorXd>(values.data(), robot.size());
}

}  // namespace

Gains default_gains(const Robot& robot) {
  Gains gains(robot.size());
  const DefaultGains& given = robot.gains;
  gains.K_x.diagonal() << Eigen::Vector3d::Constant(given.K_x_translation_N_per_m),
      Eigen::Vector3d::Constant(given.K_x_rotation_Nm_per_rad);
  gains.damping_ratio = given.damping_ratio;
  gains.K_q = vector_of(given.K_q, robot, "K_q");
  gains.joint_damping_ratio = given.joint_damping_ratio;
  gains.K_null = vector_of(given.K_null, robot, "K_null");
  gains.D_null = vector_of(given.D_null, robot, "D_null");
  return gains;
}

const char* refuse_gains(const compliance_gains_t& message, int joints) noexcept {
  if (message.num_joints != joints) return "num_joints is not the number of joints of this arm";
  if (message.orientation != compliance_gains_t::ORIENTATION_LOG &&
      message.orientation != compliance_gains_t::ORIENTATION_QUAT) {
    return "orientation must be ORIENTATION_LOG or ORIENTATION_QUAT";
  }
  if (!within(message.ramp_s, 0.0, kMaxRamp_s)) return "ramp_s must be within 0..60 s";
  if (!within(message.damping_ratio, 0.0, kMaxDampingRatio)) {
    return "damping_ratio must be within 0..2";
  }
  if (!within(message.joint_damping_ratio, 0.0, kMaxDampingRatio)) {
    return "joint_damping_ratio must be within 0..2";
  }
  if (!all_within(message.K_q, joints, kMaxAngularStiffness)) {
    return "K_q must be within 0..1e4 N m/rad";
  }
  if (!all_within(message.K_null, joints, kMaxAngularStiffness)) {
    return "K_null must be within 0..1e4 N m/rad";
  }
  if (!all_within(message.D_null, joints, kMaxNullDamping)) {
    return "D_null must be within 0..1e3 N m s/rad";
  }
  return refuse_stiffness(stiffness_of(message));
}

void read_gains(const compliance_gains_t& message, Gains* gains) noexcept {
  const auto n = gains->K_q.size();
  const Matrix6 K = stiffness_of(message);
  gains->orientation = static_cast<Orientation>(message.orientation);
  gains->K_x = 0.5 * (K + K.transpose());
  gains->damping_ratio = message.damping_ratio;
  gains->K_q = Eigen::Map<const Eigen::VectorXd>(message.K_q, n);
  gains->joint_damping_ratio = message.joint_damping_ratio;
  gains->K_null = Eigen::Map<const Eigen::VectorXd>(message.K_null, n);
  gains->D_null = Eigen::Map<const Eigen::VectorXd>(message.D_null, n);
}

void GainRamp::start(const Gains& gains, double duration_s) noexcept {
  from_ = now_;
  to_ = gains;
  now_.orientation = gains.orientation;
  elapsed_s_ = 0.0;
  duration_s_ = std::max(duration_s, kShortestRamp_s);
}

void GainRamp::advance(double dt_s) noexcept {
  if (!moving()) return;
  elapsed_s_ += dt_s;
  if (!moving()) {
    now_ = to_;
    return;
  }
  const double s = 0.5 - 0.5 * std::cos(std::numbers::pi * elapsed_s_ / duration_s_);
  now_.K_x = (1.0 - s) * from_.K_x + s * to_.K_x;
  now_.damping_ratio = (1.0 - s) * from_.damping_ratio + s * to_.damping_ratio;
  now_.K_q = (1.0 - s) * from_.K_q + s * to_.K_q;
  now_.joint_damping_ratio = (1.0 - s) * from_.joint_damping_ratio + s * to_.joint_damping_ratio;
  now_.K_null = (1.0 - s) * from_.K_null + s * to_.K_null;
  now_.D_null = (1.0 - s) * from_.D_null + s * to_.D_null;
}

}  // namespace limber::controller
