#include "controller/gains.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/config_error.h"
#include "scenarios/gains_yaml.h"

namespace limber::controller {
namespace {

using RowMajor6f = Eigen::Matrix<float, 6, 6, Eigen::RowMajor>;
using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

Matrix6 matrix(const double (&m)[6][6]) noexcept { return Eigen::Map<const RowMajor6>(&m[0][0]); }
Matrix6 matrix(const float (&m)[6][6]) noexcept {
  return Eigen::Map<const RowMajor6f>(&m[0][0]).cast<double>();
}

Matrix6 symmetric(const Matrix6& M) noexcept { return 0.5 * (M + M.transpose()); }

template <typename T>
void read_diagonal(const T (&values)[kMaxJoints], MatrixJ* M) noexcept {
  M->setZero();
  for (Eigen::Index i = 0; i < M->rows(); ++i) (*M)(i, i) = static_cast<double>(values[i]);
}

double or_default(float value, double otherwise) noexcept {
  return value > 0.0F ? static_cast<double>(value) : otherwise;
}

LawSettings read_settings(const compliance_gains_t& message) noexcept {
  LawSettings s;
  s.position = static_cast<Position>(message.position);
  s.stiffness_fit = static_cast<StiffnessFit>(message.stiffness_fit);
  s.orientation = static_cast<Orientation>(message.orientation);
  s.frame = static_cast<GainFrame>(message.frame);
  s.bias = static_cast<Bias>(message.bias);
  s.damping = static_cast<DampingDesign>(message.damping);
  s.joint_damping = static_cast<DampingDesign>(message.joint_damping);
  s.stiffness_terms = static_cast<StiffnessTerms>(message.stiffness_terms);
  s.stiffness_pose = static_cast<StiffnessPose>(message.stiffness_pose);
  s.damping_partials = static_cast<DampingPartials>(message.damping_partials);
  s.projector = static_cast<Projector>(message.projector);
  s.contact = static_cast<ContactSource>(message.contact);
  s.velocity = static_cast<VelocitySource>(message.velocity);
  s.friction = static_cast<FrictionCompensation>(message.friction);
  s.friction_share = static_cast<double>(message.friction_share);
  s.inertia_feedforward = message.inertia_feedforward != 0;
  s.follow_velocity = message.follow_velocity != 0;
  s.literal_stiffness = message.literal_stiffness != 0;
  s.velocity_cutoff_rad_per_s =
      or_default(message.velocity_cutoff_rad_per_s, s.velocity_cutoff_rad_per_s);
  s.velocity_acceleration_rad_per_s2 =
      or_default(message.velocity_acceleration_rad_per_s2, s.velocity_acceleration_rad_per_s2);
  s.acceleration_filter_s = or_default(message.acceleration_filter_s, s.acceleration_filter_s);
  s.observer_gain_per_s = or_default(message.observer_gain_per_s, s.observer_gain_per_s);
  s.friction_observer_gain_per_s =
      or_default(message.friction_observer_gain_per_s, s.friction_observer_gain_per_s);
  s.torque_gain = static_cast<double>(message.torque_gain);
  s.tank_J = static_cast<double>(message.tank_J);
  s.passivity_damping_Ns_per_m = static_cast<double>(message.passivity_damping_Ns_per_m);
  s.spring_force_N = or_default(message.spring_force_N, s.spring_force_N);
  s.spring_moment_Nm = or_default(message.spring_moment_Nm, s.spring_moment_Nm);
  for (std::size_t i = 0; i < kTerms; ++i) {
    s.period_cycles[i] = std::max<int>(message.period_cycles[i], 1);
  }
  return s;
}

}  // namespace

Gains default_gains(const Robot& robot) {
  const auto n = static_cast<std::size_t>(robot.size());
  const DefaultGains& given = robot.gains;
  if (given.K_q.size() != n || given.K_null.size() != n || given.D_null.size() != n) {
    throw ConfigError(robot.name +
                      ": gains: K_q, K_null and D_null need one value for each of the " +
                      std::to_string(n) + " joints");
  }
  Gains gains(robot.size());
  read_gains(limber::default_gains(robot), &gains);
  return gains;
}

void read_gains(const compliance_gains_t& message, Gains* gains) noexcept {
  gains->settings = read_settings(message);
  gains->K_x = symmetric(matrix(message.K_x));
  gains->damping_ratio = message.damping_ratio;
  gains->D_x = symmetric(matrix(message.D_x));
  gains->M_x = symmetric(matrix(message.M_x));
  read_diagonal(message.K_q, &gains->K_q);
  gains->joint_damping_ratio = message.joint_damping_ratio;
  read_diagonal(message.D_q, &gains->D_q);
  read_diagonal(message.M_q, &gains->M_q);
  read_diagonal(message.K_acc, &gains->K_acc);
  gains->D_acc = 2.0 * gains->joint_damping_ratio * gains->K_acc.cwiseSqrt();
  read_diagonal(message.K_null, &gains->K_null);
  read_diagonal(message.D_null, &gains->D_null);
}

void turn_to_base(const Eigen::Matrix3d& R_BD, Gains* gains) noexcept {
  if (gains->settings.frame == GainFrame::kBase) return;
  Matrix6 T = Matrix6::Zero();
  T.topLeftCorner<3, 3>() = T.bottomRightCorner<3, 3>() = R_BD;
  for (Matrix6* M : {&gains->K_x, &gains->D_x, &gains->M_x}) {
    *M = symmetric(T * *M * T.transpose());
  }
}

void GainRamp::start(const Gains& gains, double duration_s) noexcept {
  const LawSettings before = now_.settings;
  now_.settings = gains.settings;
  now_.M_x = gains.M_x;
  now_.M_q = gains.M_q;
  if (before.damping != DampingDesign::kGiven) now_.D_x = gains.D_x;
  if (before.joint_damping != DampingDesign::kGiven) now_.D_q = gains.D_q;
  from_ = now_;
  to_ = gains;
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
  const auto mix = [this, s](auto Gains::*part) {
    now_.*part = (1.0 - s) * (from_.*part) + s * (to_.*part);
  };
  for (auto part : {&Gains::K_x, &Gains::D_x}) mix(part);
  for (auto part : {&Gains::damping_ratio, &Gains::joint_damping_ratio}) mix(part);
  for (auto part :
       {&Gains::K_q, &Gains::D_q, &Gains::K_acc, &Gains::D_acc, &Gains::K_null, &Gains::D_null}) {
    mix(part);
  }
}

}  // namespace limber::controller
