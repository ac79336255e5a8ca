#include "controller/estimation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "controller/observers/coriolis_transpose.h"
#include "controller/singularity.h"

namespace limber::controller {
namespace {

constexpr double kFrictionFade_rad_per_s = 0.02;
constexpr double kLeastNoise_rad = 1e-7;

// Standard deviation of the coarsest encoder's rounding.
double rounding_noise(const Robot& robot) {
  int bits = 32;
  for (const JointConfig& joint : robot.joints) bits = std::min(bits, joint.drive.encoder_bits);
  const double count = 2.0 * std::numbers::pi / std::exp2(bits);
  return std::max(count / std::sqrt(12.0), kLeastNoise_rad);
}

FrictionFeedforward friction_model(const Robot& robot) {
  const int n = robot.size();
  FrictionFeedforward friction{VectorJ(n), VectorJ(n), 0.0, kFrictionFade_rad_per_s};
  for (int i = 0; i < n; ++i) {
    const FrictionConfig& config = robot.joints[static_cast<std::size_t>(i)].friction;
    friction.F_c[i] = config.coulomb_Nm;
    friction.d[i] = config.viscous_Nms_per_rad;
  }
  return friction;
}

MomentumObserver momentum_observer(int joints, double gain, double T) {
  return {VectorJ::Constant(joints, gain), T};
}

}  // namespace

Estimation::Estimation(const LoadedRobot& robot)
    : joints_(robot.robot.size()),
      T_(1.0 / robot.robot.rate_hz),
      q_(VectorJ::Zero(joints_)),
      v_(q_),
      position_noise_(rounding_noise(robot.robot)),
      friction_(friction_model(robot.robot)),
      filtered_difference_(joints_, settings_.velocity_cutoff_rad_per_s, T_),
      alpha_beta_(joints_, {settings_.velocity_acceleration_rad_per_s2, position_noise_, T_}, T_),
      levant_(joints_, settings_.velocity_acceleration_rad_per_s2, T_),
      momentum_(momentum_observer(joints_, std::min(settings_.observer_gain_per_s, 1.0 / T_), T_)),
      tip_acceleration_(6, 1.0 / settings_.acceleration_filter_s, T_),
      estimates_(joints_) {
  if (robot.robot.has_tip_sensor) tip_force_.emplace(robot.robot);
}

void Estimation::make_velocity_estimators() noexcept {
  const double acceleration = settings_.velocity_acceleration_rad_per_s2;
  filtered_difference_ = {joints_, settings_.velocity_cutoff_rad_per_s, T_};
  alpha_beta_ = {joints_, {acceleration, position_noise_, T_}, T_};
  levant_ = {joints_, acceleration, T_};
  if (!started_) return;
  filtered_difference_.start(q_, v_);
  alpha_beta_.start(q_, v_);
  levant_.start(q_, v_);
}

void Estimation::make_contact_observers() noexcept {
  // Beyond 1 / T the sampled observer would ring.
  momentum_ = momentum_observer(joints_, std::min(settings_.observer_gain_per_s, 1.0 / T_), T_);
  estimates_.tau_ext.setZero();
  estimates_.F_ext.setZero();
}

void Estimation::set(const LawSettings& settings) noexcept {
  const LawSettings before = settings_;
  settings_ = settings;
  if (settings.velocity != before.velocity ||
      settings.velocity_cutoff_rad_per_s != before.velocity_cutoff_rad_per_s ||
      settings.velocity_acceleration_rad_per_s2 != before.velocity_acceleration_rad_per_s2) {
    make_velocity_estimators();
  }
  if (settings.contact != before.contact ||
      settings.observer_gain_per_s != before.observer_gain_per_s) {
    make_contact_observers();
  }
  if (settings.acceleration_filter_s != before.acceleration_filter_s) {
    tip_acceleration_.set_corner(1.0 / settings.acceleration_filter_s);
  }
  friction_.share =
      settings.friction == FrictionCompensation::kModel ? settings.friction_share : 0.0;
}

void Estimation::restart() noexcept {
  started_ = false;
  make_velocity_estimators();
  make_contact_observers();
  tip_acceleration_ = {6, 1.0 / settings_.acceleration_filter_s, T_};
  estimates_.A_BT.setZero();
}

// The driver may run at another rate than robot.yaml's.
void Estimation::set_period(double T) noexcept {
  if (T == T_) return;
  T_ = T;
  restart();
}

void Estimation::estimate_velocity(ArmState* state) noexcept {
  set_period(state->period_s);
  switch (settings_.velocity) {
    case VelocitySource::kDrive:
      break;
    case VelocitySource::kFilteredDifference:
      state->v = filtered_difference_.update(state->q);
      break;
    case VelocitySource::kAlphaBeta:
      state->v = alpha_beta_.update(state->q);
      break;
    case VelocitySource::kLevant:
      state->v = levant_.update(state->q);
      break;
  }
  q_ = state->q;
  v_ = state->v;
  started_ = true;
}

void Estimation::observe(const joint_state_t& message, const ArmState& state, const ArmTerms& terms,
                         const TaskRows& rows, ArmModel* model) noexcept {
  estimates_.A_BT = tip_acceleration_.update(terms.V_BT);
  if (settings_.contact == ContactSource::kJointTorque) {
    observe_joint_torque(state, terms, rows, model);
  } else if (settings_.contact == ContactSource::kTipSensor && tip_force_) {
    tip_force_->update(message, terms, estimates_.A_BT);
    estimates_.F_ext = tip_force_->F_ext();
    estimates_.tau_ext = terms.J.transpose() * estimates_.F_ext;
  }
}

// From the motors' torque and the momentum of links and rotors: their friction is in it, too.
void Estimation::observe_joint_torque(const ArmState& state, const ArmTerms& terms,
                                      const TaskRows& rows, ArmModel* model) noexcept {
  const VectorJ beta = coriolis_transpose(model, terms, state.q, state.v) - terms.g;
  estimates_.tau_ext = momentum_.update(terms.M_total * state.v, state.tau_applied, beta);
  const DampedInverse inverse = damped_inverse(rows.of(terms.J));
  estimates_.F_ext = inverse.inverse.transpose() * estimates_.tau_ext;
}

VectorJ Estimation::friction(const VectorJ& v_d, const ArmState& state) const noexcept {
  return friction_.torque(v_d, state.v);
}

}  // namespace limber::controller
