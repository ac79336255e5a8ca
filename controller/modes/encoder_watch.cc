#include "controller/modes/encoder_watch.h"

#include <algorithm>
#include <cmath>

#include "controller/modes/friction_bound.h"

namespace limber::controller {
namespace {

constexpr double kObserver_per_s = 50.0;

auto joints_of(const double* values, int n) { return Eigen::Map<const VectorJ>(values, n); }

}  // namespace

EncoderWatch::EncoderWatch(const Robot& robot)
    : observer_(VectorJ::Constant(robot.size(), std::min(kObserver_per_s, robot.rate_hz)),
                1.0 / robot.rate_hz) {
  for (const JointConfig& joint : robot.joints)
    joints_.push_back({friction_bound(joint), joint.torque_limit_Nm, std::nullopt});
}

void EncoderWatch::reset() noexcept {
  for (Joint& joint : joints_) joint.rest.reset();
  observer_.reset();
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

EncoderWatch::Rest EncoderWatch::rest_of(const joint_state_t& state, int i,
                                         double load_Nm) const noexcept {
  return {state.theta[i],       state.q[i], state.theta_dot[i],
          state.v[i],           load_Nm,    std::to_array(state.theta),
          observer_.residual(), false,      0.0};
}

bool EncoderWatch::pushed(const joint_state_t& state, int i, const MatrixJ& M,
                          double swing) const noexcept {
  const Rest& rest = *joints_[static_cast<std::size_t>(i)].rest;
  for (int k = 0; k < state.num_joints; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const double way = state.theta[k] - rest.thetas[at];
    if (way == 0.0) continue;
    const double sign = way > 0.0 ? 1.0 : -1.0;
    const double r = observer_.residual()[k];
    const double drive_Nm = std::min(sign * r, sign * (r - rest.r[k]));
    const double of_swing_Nm = std::max(0.0, -sign * M(k, i) * swing);
    if (drive_Nm > kPushShare * joints_[at].friction_Nm + of_swing_Nm) return true;
  }
  return false;
}

int EncoderWatch::stopped(const joint_state_t& state, const Model& model, double dt_s) noexcept {
  const int n = state.num_joints;
  observer_.update(model.M * joints_of(state.v, n), joints_of(state.tau_applied, n),
                   model.CTv - model.g);
  for (int i = 0; i < n; ++i) {
    if (state.age_cycles[i] > 0) continue;
    auto& [friction_Nm, limit_Nm, rest] = joints_[static_cast<std::size_t>(i)];
    const double M_ii = model.M(i, i);
    const double load_Nm = state.tau_applied[i] - model.g[i];
    if (!rest || !rest->continues(state, i)) {
      const double speed = rest ? rest->theta_dot : 0.0;
      rest = rest_of(state, i, load_Nm);
      rest->expected_speed = speed;
      rest->sudden = std::abs(speed) >= std::max(kSudden, (limit_Nm + friction_Nm) / M_ii * dt_s);
      continue;
    }
    const double least_Nm = std::min(0.0, rest->load_Nm);
    const double most_Nm = std::max(0.0, rest->load_Nm);
    const double swing = (load_Nm - std::clamp(load_Nm, least_Nm, most_Nm)) / M_ii;
    rest->move(swing, rest->sudden ? 0.0 : friction_Nm / M_ii, dt_s);
    const bool counts = rest->sudden ? rest->stood_s >= kStood_s : rest->arm_moved(state);
    if (!counts || std::abs(rest->expected_angle) < (rest->sudden ? kCoasted : kExpected)) continue;
    if (rest->sudden || rest->pushes == kPushes || !pushed(state, i, model.M, swing)) return i;
    const int pushes = rest->pushes + 1;
    rest = rest_of(state, i, load_Nm);
    rest->pushes = pushes;
  }
  return -1;
}

}  // namespace limber::controller
