#include "controller/watches/encoder_watch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "controller/watches/friction_bound.h"

namespace limber::controller {
namespace {

constexpr double kObserver_per_s = 50.0;
constexpr double kNoise = 6.0;  // standard deviations
constexpr double kCounts = 4.0;
constexpr double kTurn = 2.0 * std::numbers::pi;

VectorJ joints_of(const double* values, int n) noexcept {
  return Eigen::Map<const VectorJ>(values, n);
}

/// The change of the spring's torque that standing encoders exclude, N m.
double stretch_bound(const JointConfig& joint) {
  const SpringConfig& spring = joint.transmission.spring;
  const bool linear =
      joint.transmission.kind == TransmissionKind::kElastic && spring.law == SpringLaw::kLinear;
  if (!linear || !joint.link_encoder.present || !joint.torque_sensor.present)
    return std::numeric_limits<double>::infinity();
  const double count_rad =
      kTurn / joint.drive.counts_per_turn + std::ldexp(kTurn, -joint.link_encoder.bits);
  const TorqueSensorConfig& sensor = joint.torque_sensor;
  return std::max({EncoderWatch::kStretchShare * joint.torque_limit_Nm,
                   kNoise * sensor.noise_Nm + sensor.resolution_Nm,
                   kCounts * count_rad * spring.stiffness_Nm_per_rad});
}

}  // namespace

EncoderWatch::EncoderWatch(const Robot& robot)
    : observer_(VectorJ::Constant(robot.size(), std::min(kObserver_per_s, robot.rate_hz)),
                1.0 / robot.rate_hz) {
  for (const JointConfig& joint : robot.joints)
    joints_.push_back({friction_bound(joint), joint.torque_limit_Nm,
                       kBelievable * joint.velocity_limit, joint.rigid(), stretch_bound(joint),
                       std::nullopt});
}

void EncoderWatch::reset() noexcept {
  for (Joint& joint : joints_) joint.rest.reset();
  observer_.reset();
  observed_s_ = 0.0;
}

bool EncoderWatch::Rest::continues(const joint_state_t& state, int i) const noexcept {
  return state.theta[i] == theta && state.q[i] == q && state.theta_dot[i] == theta_dot &&
         state.v[i] == v;
}

bool EncoderWatch::Rest::arm_moved(const joint_state_t& state) const noexcept {
  for (int k = 0; k < state.num_joints; ++k) {
    if (std::abs(state.theta[k] - thetas[static_cast<std::size_t>(k)]) > kOthers) return true;
  }
  return false;
}

// Coulomb friction by an implicit step: it brings to rest, and holds at rest.
void EncoderWatch::Rest::move(double acceleration, double friction, double dt_s) noexcept {
  const double free = expected_speed + acceleration * dt_s;
  expected_speed = std::copysign(std::max(0.0, std::abs(free) - friction * dt_s), free);
  expected_angle += expected_speed * dt_s;
  stood_s += dt_s;
}

// What the sensor filters or delays has arrived kStood_s after the last motion.
bool EncoderWatch::Rest::stretched(double sensor_Nm, double most_Nm, double dt_s) noexcept {
  const double change_Nm = sensor_Nm - spring_Nm;
  const bool arriving = stood_s <= kStood_s;
  spring_Nm += arriving ? change_Nm : change_Nm * std::min(1.0, dt_s / kDrift_s);
  const bool before = contradicts;
  contradicts = !arriving && !(std::abs(change_Nm) <= most_Nm);
  contradicts_s = before && contradicts ? contradicts_s + dt_s : 0.0;
  return contradicts_s >= kStood_s;
}

double EncoderWatch::held_Nm(const joint_state_t& state, int i, const MatrixJ& M) const noexcept {
  const Rest& rest = *joints_[static_cast<std::size_t>(i)].rest;
  double held = 0.0;
  for (int k = 0; k < state.num_joints; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const double way = state.theta[k] - rest.thetas[at];
    if (std::abs(way) <= kOthers || std::abs(state.theta_dot[k]) > kYields) continue;
    const double along = std::copysign(1.0, way);
    const double residual = observer_.residual()[k];
    const double push_Nm = std::min(along * residual, along * (residual - rest.residual[k]));
    if (push_Nm > kFeltShare * joints_[at].friction_Nm)
      held = std::max(held, kHeldShare * push_Nm * std::sqrt(M(i, i) / M(k, k)));
  }
  return held;
}

bool EncoderWatch::Joint::stops_suddenly(double speed, double inertia, double load_Nm,
                                         double dt_s) const noexcept {
  const double way = std::abs(speed) * dt_s;
  const double contact_Nm = rigid ? std::abs(load_Nm) + limit_Nm * way / kGivesWay : limit_Nm;
  const double brakes_Nm = friction_Nm + std::min(limit_Nm, contact_Nm);
  return std::abs(speed) >= std::max(kSudden, brakes_Nm / inertia * dt_s);
}

bool EncoderWatch::believable(const joint_state_t& state) const noexcept {
  for (int i = 0; i < state.num_joints; ++i) {
    const double most = joints_[static_cast<std::size_t>(i)].believable_speed;
    if (!(std::abs(state.v[i]) <= most && std::abs(state.theta_dot[i]) <= most)) return false;
  }
  return true;
}

int EncoderWatch::stopped(const joint_state_t& state, const Model& model, double dt_s) noexcept {
  const int n = state.num_joints;
  if (!believable(state)) return -1;
  observer_.update(model.M * joints_of(state.v, n), joints_of(state.tau_applied, n),
                   model.CTv - model.gravity);
  observed_s_ += dt_s;
  for (int i = 0; i < n; ++i) {
    if (state.age_cycles[i] > 0) continue;
    Joint& joint = joints_[static_cast<std::size_t>(i)];
    std::optional<Rest>& rest = joint.rest;
    const double M_ii = model.M(i, i);
    const auto load = [&](bool sudden) -> double {
      return sudden ? state.tau_applied[i] - model.gravity[i] : -observer_.residual()[i];
    };
    if (!rest || !rest->continues(state, i)) {
      const double speed = rest ? rest->theta_dot : 0.0;
      const bool sudden = joint.stops_suddenly(speed, M_ii, load(true), dt_s);
      rest = {state.theta[i], state.q[i],   state.theta_dot[i],         state.v[i],
              load(sudden),   state.tau[i], std::to_array(state.theta), observer_.residual(),
              sudden,         speed};
      continue;
    }
    const double load_Nm = load(rest->sudden);
    if (observed_s_ < kSettled_s) {
      rest->residual = observer_.residual();
      rest->load_Nm = load_Nm;
    }
    const double friction_Nm = rest->sudden ? 0.0 : joint.friction_Nm;
    const double contact_Nm = rest->sudden ? 0.0 : held_Nm(state, i, model.M);
    const double turns_Nm =
        rest->stood_s >= kRests_s ? std::max(0.0, friction_Nm - contact_Nm) : 0.0;
    const double least_Nm = std::min(0.0, rest->load_Nm - turns_Nm);
    const double most_Nm = std::max(0.0, rest->load_Nm + turns_Nm);
    const double tau = load_Nm - std::clamp(load_Nm, least_Nm, most_Nm);
    rest->move(tau / M_ii, (friction_Nm + contact_Nm) / M_ii, dt_s);
    if (rest->stretched(state.tau[i], joint.stretch_Nm, dt_s)) return i;
    const double angle = std::abs(rest->expected_angle);
    if (rest->sudden) {
      if (rest->stood_s >= kStood_s && angle >= kCoasted) return i;
    } else if (angle >= kExpected && rest->arm_moved(state)) {
      return i;
    }
  }
  return -1;
}

}  // namespace limber::controller
