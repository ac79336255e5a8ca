// The state of the joints in one cycle, as vectors.
#pragma once

#include <cstdint>
#include <limber/joint_state_t.hpp>

#include "common/types.h"

#pragma GCC visibility push(default)
namespace limber::controller {

/// Of the force/torque sensor at the tip: the wrench in the sensor's axes and at its origin, N and
/// N m, and its age.
struct TipReading {
  Vector6 F = Vector6::Zero();
  std::int32_t age_cycles = 0;
  bool usable = false;  ///< false: no sensor, an error, or too old to rely on
};

/// Positions, torques and preload as the joints report them; v and theta_dot likewise, or estimated
/// from position where LawSettings::velocity names an estimator (v of rigid arms, theta_dot of arms
/// with springs). Laws follow these; limits judge what is reported. Joint order of robot.yaml; rad,
/// rad/s, N m (m, m/s, N for prismatic joints).
struct ArmState {
  explicit ArmState(int joints)
      : q(VectorJ::Zero(joints)),
        v(VectorJ::Zero(joints)),
        theta(VectorJ::Zero(joints)),
        theta_dot(VectorJ::Zero(joints)),
        v_reported(VectorJ::Zero(joints)),
        theta_dot_reported(VectorJ::Zero(joints)),
        preload(VectorJ::Zero(joints)),
        preload_dot(VectorJ::Zero(joints)),
        tau_measured(VectorJ::Zero(joints)),
        tau_applied(VectorJ::Zero(joints)),
        tau_preload_applied(VectorJ::Zero(joints)) {}

  VectorJ q;           ///< link side; the motor's where the joint has no link encoder
  VectorJ v;           ///< likewise
  VectorJ theta;       ///< motor side, behind the gear; of two motors (theta_1 - theta_2) / 2
  VectorJ theta_dot;   ///< likewise
  VectorJ v_reported;  ///< by the drives, whatever v is
  VectorJ theta_dot_reported;  ///< likewise
  VectorJ preload;             ///< (theta_1 + theta_2) / 2; zero for joints with one motor
  VectorJ preload_dot;         ///< likewise
  VectorJ tau_measured;        ///< torque on the link by a torque sensor, else the drive's estimate
  VectorJ tau_applied;         ///< what the drive was sent in this cycle
  VectorJ tau_preload_applied;  ///< the same for the preload of two motors, tau_1 + tau_2
  TipReading tip;
  std::int64_t time_ns = 0;
  double period_s = 0.0;
};

/// The point at which the law and the model are evaluated: q is the position that
/// PositionFeedback names, v the velocity of the motors, which damping acts on. On rigid arms both
/// are the joints'. n, rad and rad/s.
struct ControlPoint {
  explicit ControlPoint(int joints) : q(VectorJ::Zero(joints)), v(q) {}

  VectorJ q;
  VectorJ v;
};

/// May be called in the cycle.
inline TipReading read_tip(const joint_state_t& message) noexcept {
  return {Eigen::Map<const Vector6>(message.F_sensor), message.sensor_age_cycles,
          message.sensor_state == joint_state_t::SENSOR_FRESH ||
              message.sensor_state == joint_state_t::SENSOR_STALE};
}

/// Copies a message that has been judged usable. May be called in the cycle.
inline void read_arm_state(const joint_state_t& message, ArmState* state) noexcept {
  const auto n = state->q.size();
  state->q = Eigen::Map<const Eigen::VectorXd>(message.q, n);
  state->v = Eigen::Map<const Eigen::VectorXd>(message.v, n);
  state->theta = Eigen::Map<const Eigen::VectorXd>(message.theta, n);
  state->theta_dot = Eigen::Map<const Eigen::VectorXd>(message.theta_dot, n);
  state->v_reported = state->v;
  state->theta_dot_reported = state->theta_dot;
  state->preload = Eigen::Map<const Eigen::VectorXf>(message.preload, n).cast<double>();
  state->preload_dot = Eigen::Map<const Eigen::VectorXf>(message.preload_dot, n).cast<double>();
  state->tau_measured = Eigen::Map<const Eigen::VectorXd>(message.tau, n);
  state->tau_applied = Eigen::Map<const Eigen::VectorXd>(message.tau_applied, n);
  state->tau_preload_applied =
      Eigen::Map<const Eigen::VectorXf>(message.tau_preload_applied, n).cast<double>();
  state->tip = read_tip(message);
  state->time_ns = message.time_ns;
  state->period_s = static_cast<double>(message.period_ns) * 1e-9;
}

}  // namespace limber::controller
#pragma GCC visibility pop
