#include "controller/observers/observers.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "controller/kinds/sensors.h"
#include "controller/model/singularity.h"
#include "robots/loader/load_robot.h"

namespace limber::controller {
namespace {

constexpr double kFrictionFade_rad_per_s = 0.02;
constexpr double kLeastNoise_rad = 1e-7;
constexpr double kLeastInertia_kgm2 =
    1e-9;  // a rotor without any: friction is the difference of torques

// Standard deviation of the coarsest encoder's rounding.
double rounding_noise(const Robot& robot) {
  double count = 0.0;
  for (const JointConfig& joint : robot.joints)
    count = std::max(count, 2.0 * std::numbers::pi / joint.drive.counts_per_turn);
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

Observers::Observers(const LoadedRobot& robot)
    : joints_(robot.robot.size()),
      elastic_((sensors_of(robot.robot) & sensors::kSprings) != 0),
      torque_sensors_((sensors_of(robot.robot) & sensors::kTorqueSensor) != 0),
      T_(1.0 / robot.robot.rate_hz),
      q_(VectorJ::Zero(joints_)),
      v_(q_),
      position_noise_(rounding_noise(robot.robot)),
      friction_(friction_model(robot.robot)),
      dither_(robot.robot),
      filtered_difference_(joints_, settings_.velocity_cutoff_rad_per_s, T_),
      alpha_beta_(joints_, {settings_.velocity_acceleration_rad_per_s2, position_noise_, T_}, T_),
      levant_(joints_, settings_.velocity_acceleration_rad_per_s2, T_),
      momentum_(momentum_observer(joints_, std::min(settings_.observer_gain_per_s, 1.0 / T_), T_)),
      tip_acceleration_(6, 1.0 / settings_.acceleration_filter_s, T_),
      rotor_inertia_(ArmModel(robot).rotor_inertia().cwiseMax(kLeastInertia_kgm2)),
      estimates_(joints_) {
  if (robot.robot.has_tip_sensor) tip_force_.emplace(robot.robot);
}

void Observers::make_velocity_estimators() noexcept {
  const double acceleration = settings_.velocity_acceleration_rad_per_s2;
  filtered_difference_ = {joints_, settings_.velocity_cutoff_rad_per_s, T_};
  alpha_beta_ = {joints_, {acceleration, position_noise_, T_}, T_};
  levant_ = {joints_, acceleration, T_};
  if (!started_) return;
  filtered_difference_.start(q_, v_);
  alpha_beta_.start(q_, v_);
  levant_.start(q_, v_);
}

void Observers::make_contact_observers() noexcept {
  // Beyond 1 / T the sampled observer would ring.
  momentum_ = momentum_observer(joints_, std::min(settings_.observer_gain_per_s, 1.0 / T_), T_);
  estimates_.tau_ext.setZero();
  estimates_.F_ext.setZero();
}

void Observers::make_friction_observer() noexcept {
  if (settings_.friction_compensation != FrictionCompensation::kObserver || !torque_sensors_)
    return;
  const double gain = std::min(settings_.friction_observer_gain_per_s, 1.0 / T_);
  friction_observer_.emplace(rotor_inertia_, VectorJ::Constant(joints_, gain), T_);
}

void Observers::set(const LawSettings& settings) noexcept {
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
  if (settings.friction_compensation != before.friction_compensation ||
      settings.friction_observer_gain_per_s != before.friction_observer_gain_per_s) {
    make_friction_observer();
    dither_.restart();
  }
  if (settings.acceleration_filter_s != before.acceleration_filter_s) {
    tip_acceleration_.set_corner(1.0 / settings.acceleration_filter_s);
  }
  friction_.share = settings.friction_compensation == FrictionCompensation::kModel
                        ? settings.friction_share
                        : 0.0;
}

void Observers::restart() noexcept {
  started_ = false;
  make_velocity_estimators();
  make_contact_observers();
  make_friction_observer();
  dither_.restart();
  tip_acceleration_ = {6, 1.0 / settings_.acceleration_filter_s, T_};
  estimates_.A_BT.setZero();
}

// The driver may run at another rate than robot.yaml's.
void Observers::set_period(double T) noexcept {
  if (T == T_) return;
  T_ = T;
  restart();
}

void Observers::estimate_velocity(ArmState* state) noexcept {
  set_period(state->period_s);
  const VectorJ& position = elastic_ ? state->theta : state->q;
  VectorJ& velocity = elastic_ ? state->theta_dot : state->v;
  switch (settings_.velocity) {
    case VelocitySource::kDrive:
      break;
    case VelocitySource::kFilteredDifference:
      velocity = filtered_difference_.update(position);
      break;
    case VelocitySource::kAlphaBeta:
      velocity = alpha_beta_.update(position);
      break;
    case VelocitySource::kLevant:
      velocity = levant_.update(position);
      break;
  }
  q_ = position;
  v_ = velocity;
  started_ = true;
}

void Observers::observe(const ArmState& state, const ArmTerms& terms,
                        const TaskRows& rows) noexcept {
  estimates_.A_BT = tip_acceleration_.update(terms.V_BT);
  if (settings_.friction_compensation == FrictionCompensation::kObserver) observe_friction(state);
  if (settings_.contact == ContactSource::kJointTorque) {
    observe_joint_torque(state, terms, rows);
  } else if (settings_.contact == ContactSource::kTipSensor && tip_force_) {
    tip_force_->update(state.tip, terms, estimates_.A_BT);
    estimates_.F_ext = tip_force_->F_ext();
    estimates_.tau_ext = terms.J.transpose() * estimates_.F_ext;
  }
}

void Observers::observe_friction(const ArmState& state) noexcept {
  if (!friction_observer_) return;
  friction_observer_->update(state.theta_dot, state.tau_applied, state.tau_measured);
}

// From the sensed torque and the momentum of the links alone; or from the motors' torque and the
// momentum of links and rotors: their friction is then in it, too.
void Observers::observe_joint_torque(const ArmState& state, const ArmTerms& terms,
                                     const TaskRows& rows) noexcept {
  const VectorJ beta = terms.CTv - terms.g;
  estimates_.tau_ext = torque_sensors_
                           ? momentum_.update(terms.M * state.v, state.tau_measured, beta)
                           : momentum_.update(terms.M_total * state.v, state.tau_applied, beta);
  estimates_.F_ext = damped_pseudo_inverse(rows.of(terms.J)).transpose() * estimates_.tau_ext;
}

VectorJ Observers::friction(const Goal& goal, GoalType type, const VectorJ& v,
                            const ArmTerms& terms) noexcept {
  if (settings_.friction_compensation == FrictionCompensation::kDither)
    return dither_.next(terms.M_total.diagonal(), T_);
  if (settings_.friction_compensation == FrictionCompensation::kObserver && friction_observer_) {
    return settings_.friction_share * friction_observer_->friction();
  }
  VectorJ v_d = VectorJ::Zero(v.size());
  if (follows_joints(type)) {
    v_d = goal.v_d;
  } else if (!goal.V_BD.isZero(0.0)) {
    v_d = damped_pseudo_inverse(terms.J) * goal.V_BD;
  }
  return friction_.torque(v_d, v);
}

}  // namespace limber::controller
