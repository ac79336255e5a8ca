// What a gains message may not say.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <string>

#include "controller/gains.h"

namespace limber::controller {
namespace {

using Message = compliance_gains_t;

// What rounding may do to a matrix that was symmetric and positive semidefinite on paper; floats
// carry seven digits.
constexpr double kRounding = 1e-9;
constexpr double kFloatRounding = 1e-6;
constexpr int kLongestPeriod = 1000;  // cycles

bool within(double x, double low, double high) noexcept { return x >= low && x <= high; }

template <typename T>
bool all_within(const T (&values)[kMaxJoints], int count, double high) noexcept {
  return std::all_of(values, values + count, [high](T x) { return within(x, 0.0, high); });
}

template <typename T>
Matrix6 matrix(const T (&values)[6][6]) noexcept {
  Matrix6 M;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) M(i, j) = static_cast<double>(values[i][j]);
  }
  return M;
}

bool is_symmetric(const Matrix6& M, double rounding) noexcept {
  return (M - M.transpose()).cwiseAbs().maxCoeff() <= rounding * M.cwiseAbs().maxCoeff();
}

bool is_semidefinite(const Matrix6& M, double rounding) noexcept {
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(M, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues().minCoeff() >= -rounding * M.cwiseAbs().maxCoeff();
}

bool diagonal_within(const Matrix6& M, double linear, double angular, bool negative) noexcept {
  for (int i = 0; i < 6; ++i) {
    const double high = i < 3 ? linear : angular;
    if (!within(M(i, i), negative ? -high : 0.0, high)) return false;
  }
  return true;
}

const char* refuse_tip_matrices(const Message& message) noexcept {
  const Matrix6 K = matrix(message.K_x);
  const Matrix6 D = matrix(message.D_x);
  const Matrix6 M = matrix(message.M_x);
  if (!K.allFinite()) return "K_x is not finite";
  if (!diagonal_within(K, 1e5, 1e4, false)) {
    return "K_x: the diagonal must be within 0..1e5 N/m and 0..1e4 N m/rad";
  }
  if (!is_symmetric(K, kRounding)) return "K_x is not symmetric";
  if (!is_semidefinite(K, kRounding)) return "K_x is not positive semidefinite";
  if (!D.allFinite()) return "D_x is not finite";
  if (!diagonal_within(D, 1e4, 1e3, false)) {
    return "D_x: the diagonal must be within 0..1e4 N s/m and 0..1e3 N m s/rad";
  }
  if (!is_symmetric(D, kFloatRounding)) return "D_x is not symmetric";
  if (!is_semidefinite(D, kFloatRounding)) return "D_x is not positive semidefinite";
  if (!M.allFinite()) return "M_x is not finite";
  if (!diagonal_within(M, 1e3, 1e2, true)) {
    return "M_x: the diagonal must be within -1e3..1e3 kg and -1e2..1e2 kg m^2";
  }
  if (!is_symmetric(M, kFloatRounding)) return "M_x is not symmetric";
  if (!(M.cwiseAbs().maxCoeff() <= 1e3)) return "M_x must be within -1e3..1e3";
  return nullptr;
}

const char* refuse_joint_values(const Message& message, int n) noexcept {
  if (!all_within(message.K_q, n, 1e4)) return "K_q must be within 0..1e4 N m/rad";
  if (!all_within(message.D_q, n, 1e3)) return "D_q must be within 0..1e3 N m s/rad";
  if (!all_within(message.M_q, n, 1e2)) return "M_q must be within 0..1e2 kg m^2";
  if (!all_within(message.K_acc, n, 1e5)) return "K_acc must be within 0..1e5 1/s^2";
  if (!all_within(message.K_null, n, 1e4)) return "K_null must be within 0..1e4 N m/rad";
  if (!all_within(message.D_null, n, 1e3)) return "D_null must be within 0..1e3 N m s/rad";
  return nullptr;
}

struct Choice {
  std::int8_t Message::*field;
  int last;
  const char* problem;
};

constexpr Choice kChoices[] = {
    {&Message::position, 3, "position must be one of POSITION_*"},
    {&Message::stiffness_fit, 2, "stiffness_fit must be one of FIT_*"},
    {&Message::orientation, 4, "orientation must be one of ORIENTATION_*"},
    {&Message::frame, 1, "frame must be one of FRAME_*"},
    {&Message::bias, 3, "bias must be one of BIAS_*"},
    {&Message::damping, 3, "damping must be one of DAMPING_*"},
    {&Message::joint_damping, 3, "joint_damping must be one of DAMPING_*"},
    {&Message::stiffness_terms, 2, "stiffness_terms must be one of STIFFNESS_*"},
    {&Message::stiffness_pose, 3, "stiffness_pose must be one of POSE_*"},
    {&Message::damping_partials, 2, "damping_partials must be one of PARTIALS_*"},
    {&Message::projector, 2, "projector must be one of PROJECTOR_*"},
    {&Message::contact, 2, "contact must be one of CONTACT_*"},
    {&Message::velocity, 3, "velocity must be one of VELOCITY_*"},
    {&Message::friction, 2, "friction must be one of FRICTION_*"},
    {&Message::inertia_feedforward, 1, "inertia_feedforward must be 0 or 1"},
    {&Message::follow_velocity, 1, "follow_velocity must be 0 or 1"},
    {&Message::literal_stiffness, 1, "literal_stiffness must be 0 or 1"},
};

struct Setting {
  float Message::*field;
  double high;
  const char* problem;
};

constexpr Setting kSettings[] = {
    {&Message::friction_share, 1.0, "friction_share must be within 0..1"},
    {&Message::velocity_cutoff_rad_per_s, 1e4, "velocity_cutoff must be within 0..1e4 rad/s"},
    {&Message::velocity_acceleration_rad_per_s2, 1e5,
     "velocity_acceleration must be within 0..1e5 rad/s^2"},
    {&Message::acceleration_filter_s, 1.0, "acceleration_filter_s must be within 0..1 s"},
    {&Message::observer_gain_per_s, 500.0, "observer_gain must be within 0..500 1/s"},
    {&Message::friction_observer_gain_per_s, 500.0,
     "friction_observer_gain must be within 0..500 1/s"},
    {&Message::torque_gain, 20.0, "torque_gain must be within 0..20"},
    {&Message::tank_J, 100.0, "tank_J must be within 0..100 J"},
    {&Message::passivity_damping_Ns_per_m, 1e3, "passivity_damping must be within 0..1e3 N s/m"},
    {&Message::spring_force_N, 1e4, "spring_force_N must be within 0..1e4 N"},
    {&Message::spring_moment_Nm, 1e4, "spring_moment_Nm must be within 0..1e4 N m"},
};

const char* refuse_settings(const Message& message) noexcept {
  for (const Choice& choice : kChoices) {
    if (!within(message.*choice.field, 0.0, choice.last)) return choice.problem;
  }
  for (const Setting& setting : kSettings) {
    if (!within(message.*setting.field, 0.0, setting.high)) return setting.problem;
  }
  for (const std::int16_t period : message.period_cycles) {
    if (!within(period, 0.0, kLongestPeriod)) return "period_cycles must be within 0..1000";
  }
  return nullptr;
}

}  // namespace

const char* refuse_gains(const Message& message, int joints) noexcept {
  if (message.num_joints != joints) return "num_joints is not the number of joints of this arm";
  if (!within(message.ramp_s, 0.0, 60.0)) return "ramp_s must be within 0..60 s";
  if (!within(message.damping_ratio, 0.0, 2.0)) return "damping_ratio must be within 0..2";
  if (!within(message.joint_damping_ratio, 0.0, 2.0)) {
    return "joint_damping_ratio must be within 0..2";
  }
  if (const char* reason = refuse_settings(message)) return reason;
  if (const char* reason = refuse_joint_values(message, joints)) return reason;
  return refuse_tip_matrices(message);
}

}  // namespace limber::controller
