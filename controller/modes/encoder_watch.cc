#include "controller/modes/encoder_watch.h"

#include <algorithm>
#include <cmath>

namespace limber::controller {

EncoderWatch::EncoderWatch(const Robot& robot) {
  for (const JointConfig& joint : robot.joints) {
    const double known =
        std::max(joint.friction.coulomb_Nm, joint.friction.static_Nm) * joint.motors() +
        std::max(joint.link_friction.coulomb_Nm, joint.link_friction.static_Nm);
    joints_.push_back({std::max(known, kFrictionShare * joint.torque_limit_Nm), std::nullopt});
  }
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

int EncoderWatch::stopped(const joint_state_t& state, const VectorJ& gravity, const MatrixJ& M,
                          double dt_s) noexcept {
  for (int i = 0; i < state.num_joints; ++i) {
    auto& [friction_Nm, rest] = joints_[static_cast<std::size_t>(i)];
    const double load_Nm = state.tau_applied[i] - gravity[i];
    if (!rest || !rest->continues(state, i)) {
      rest = {state.theta[i], state.q[i], state.theta_dot[i],
              state.v[i],     load_Nm,    std::to_array(state.theta)};
    }
    const double least_Nm = std::min(0.0, rest->load_Nm);
    const double most_Nm = std::max(0.0, rest->load_Nm);
    const double tau = load_Nm - std::clamp(load_Nm, least_Nm, most_Nm);
    const double excess = std::copysign(std::max(0.0, std::abs(tau) - friction_Nm), tau);
    rest->expected_speed += excess / M(i, i) * dt_s;
    rest->expected_angle += rest->expected_speed * dt_s;
    if (std::abs(rest->expected_angle) >= kExpected && rest->arm_moved(state)) return i;
  }
  return -1;
}

}  // namespace limber::controller
