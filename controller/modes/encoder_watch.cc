#include "controller/modes/encoder_watch.h"

#include <algorithm>
#include <cmath>

namespace limber::controller {

EncoderWatch::EncoderWatch(const Robot& robot) {
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const JointConfig& joint = robot.joints[i];
    const double known =
        std::max(joint.friction.coulomb_Nm, joint.friction.static_Nm) * joint.motors() +
        std::max(joint.link_friction.coulomb_Nm, joint.link_friction.static_Nm);
    joints_[i].friction_Nm = std::max(known, kFrictionShare * joint.torque_limit_Nm);
  }
}

void EncoderWatch::reset() noexcept {
  for (Joint& joint : joints_) joint.known = false;
}

bool EncoderWatch::unchanged(const Joint& joint, const joint_state_t& state, int i) noexcept {
  return joint.known && state.theta[i] == joint.theta && state.q[i] == joint.q &&
         state.theta_dot[i] == joint.theta_dot && state.v[i] == joint.v;
}

bool EncoderWatch::others_moved(const Joint& joint, const joint_state_t& state, int i) noexcept {
  for (int k = 0; k < state.num_joints; ++k) {
    if (k != i && std::abs(state.theta[k] - joint.others[static_cast<std::size_t>(k)]) > kOthers)
      return true;
  }
  return false;
}

int EncoderWatch::stopped(const joint_state_t& state, const VectorJ& gravity, const MatrixJ& M,
                          double dt_s) noexcept {
  for (int i = 0; i < state.num_joints; ++i) {
    Joint& joint = joints_[static_cast<std::size_t>(i)];
    if (!unchanged(joint, state, i)) {
      joint.theta = state.theta[i];
      joint.q = state.q[i];
      joint.theta_dot = state.theta_dot[i];
      joint.v = state.v[i];
      joint.load_Nm = state.tau_applied[i] - gravity[i];
      joint.expected_speed = joint.expected_angle = 0.0;
      std::copy_n(state.theta, kMaxJoints, joint.others.begin());
      joint.known = true;
      continue;
    }
    const double tau = state.tau_applied[i] - gravity[i] - joint.load_Nm;
    const double excess = std::copysign(std::max(0.0, std::abs(tau) - joint.friction_Nm), tau);
    joint.expected_speed += excess / M(i, i) * dt_s;
    joint.expected_angle += joint.expected_speed * dt_s;
    if (std::abs(joint.expected_angle) >= kExpected && others_moved(joint, state, i)) return i;
  }
  return -1;
}

}  // namespace limber::controller
