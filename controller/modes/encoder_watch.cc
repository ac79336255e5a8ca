#include "controller/modes/encoder_watch.h"

#include <algorithm>
#include <cmath>

#include "controller/modes/friction_bound.h"

namespace limber::controller {

EncoderWatch::EncoderWatch(const Robot& robot) {
  for (const JointConfig& joint : robot.joints)
    joints_.push_back({friction_bound(joint), joint.torque_limit_Nm, std::nullopt});
}

void EncoderWatch::reset() noexcept {
  for (Joint& joint : joints_) joint.rest.reset();
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

int EncoderWatch::stopped(const joint_state_t& state, const VectorJ& gravity, const MatrixJ& M,
                          double dt_s) noexcept {
  for (int i = 0; i < state.num_joints; ++i) {
    if (state.age_cycles[i] > 0) continue;
    auto& [friction_Nm, limit_Nm, rest] = joints_[static_cast<std::size_t>(i)];
    const double M_ii = M(i, i);
    const double load_Nm = state.tau_applied[i] - gravity[i];
    if (!rest || !rest->continues(state, i)) {
      const double speed = rest ? rest->theta_dot : 0.0;
      const bool sudden =
          std::abs(speed) >= std::max(kSudden, (limit_Nm + friction_Nm) / M_ii * dt_s);
      rest = {state.theta[i], state.q[i], state.theta_dot[i],
              state.v[i],     load_Nm,    std::to_array(state.theta),
              sudden,         speed};
      continue;
    }
    const double least_Nm = std::min(0.0, rest->load_Nm);
    const double most_Nm = std::max(0.0, rest->load_Nm);
    const double tau = load_Nm - std::clamp(load_Nm, least_Nm, most_Nm);
    rest->move(tau / M_ii, rest->sudden ? 0.0 : friction_Nm / M_ii, dt_s);
    const bool counts = rest->sudden ? rest->stood_s >= kStood_s : rest->arm_moved(state);
    if (counts && std::abs(rest->expected_angle) >= (rest->sudden ? kCoasted : kExpected)) return i;
  }
  return -1;
}

}  // namespace limber::controller
