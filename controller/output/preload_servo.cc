#include "controller/output/preload_servo.h"

#include <algorithm>
#include <limber/controller_status_t.hpp>

#include "controller/output/torque_limiter.h"

namespace limber::controller {
namespace {

// The gate's step of the preload, in steps of the torque.
constexpr double kGateSteps = 2.0;

}  // namespace

PreloadServo::PreloadServo(const Robot& robot)
    : at_rest_(VectorJ::Zero(robot.size())), c_d_(at_rest_), blend_(robot.size()), tau_(at_rest_) {
  for (int i = 0; i < robot.size(); ++i) {
    const JointConfig& joint = robot.joints[static_cast<std::size_t>(i)];
    if (!joint.has_antagonist) continue;
    at_rest_[i] = joint.transmission.preload_rad;
    pairs_.push_back({i,
                      {joint.transmission.spring},
                      joint.drive.rotor_inertia_kgm2 + joint.antagonist.rotor_inertia_kgm2,
                      joint.transmission.preload_max_rad,
                      std::min(joint.drive.peak_torque_Nm, joint.antagonist.peak_torque_Nm),
                      joint.torque_rate_limit_Nm_per_s});
  }
}

void PreloadServo::rest(const ArmState& state, PreloadAtRest where, bool in_steps) noexcept {
  resting_ = true;
  for (const Motors& pair : pairs_) {
    const Eigen::Index i = pair.joint;
    c_d_[i] = state.preload[i];
    const double applied = where == PreloadAtRest::kAsApplied ? state.tau_preload_applied[i] : 0.0;
    const double target = std::clamp(applied, -2.0 * pair.torque_Nm, 2.0 * pair.torque_Nm);
    const double step = kShareOfGateStep * pair.rate_Nm_per_s * state.period_s;
    tau_[i] = in_steps ? std::clamp(target, tau_[i] - step, tau_[i] + step) : target;
  }
}

double PreloadServo::servo(const Motors& pair, const ArmState& state, double wanted, double x,
                           double dt_s) noexcept {
  const Eigen::Index i = pair.joint;
  const double goal = std::clamp(wanted, 0.0, pair.preload_max_rad);
  const double step = pair.preload_max_rad / kRampTime_s * dt_s;
  const double before = c_d_[i];
  c_d_[i] = std::clamp(goal, before - step, before + step);
  const double K = pair.B * kBandwidth_rad_per_s * kBandwidth_rad_per_s;
  const double D = 2.0 * pair.B * kBandwidth_rad_per_s;
  return pair.springs.preload_torque(c_d_[i], x) - K * (state.preload[i] - c_d_[i]) -
         D * state.preload_dot[i];
}

std::int32_t PreloadServo::control(const ArmState& state, const VectorJ& wanted, const VectorJ& x,
                                   const VectorJ& tau, double dt_s) noexcept {
  VectorJ all = tau_;
  for (const Motors& pair : pairs_) {
    const double torque = servo(pair, state, wanted[pair.joint], x[pair.joint], dt_s);
    if (std::isfinite(torque)) all[pair.joint] = torque;
  }
  blend_.advance(dt_s, state.preload_dot);
  if (resting_) blend_.start(tau_, all);
  resting_ = false;
  blend_.add_to(&all);

  std::int32_t acted = 0;
  for (const Motors& pair : pairs_) {
    const Eigen::Index i = pair.joint;
    const double asked = all[i];
    const double room = std::max(2.0 * pair.torque_Nm - std::abs(tau[i]), 0.0);
    const double limited = std::clamp(asked, -room, room);
    const double step = kShareOfGateStep * pair.rate_Nm_per_s * state.period_s;
    const double applied = state.tau_preload_applied[i];
    const double reach = kGateSteps * kShareFromApplied * pair.rate_Nm_per_s * state.period_s;
    tau_[i] = std::clamp(std::clamp(limited, tau_[i] - step, tau_[i] + step), applied - reach,
                         applied + reach);
    if (limited != asked) acted |= controller_status_t::LIMIT_TORQUE;
    if (limited != tau_[i]) acted |= controller_status_t::LIMIT_RATE;
  }
  return acted;
}

}  // namespace limber::controller
