#include "controller/watches/load_watch.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "controller/watches/friction_bound.h"

namespace limber::controller {

LoadWatch::LoadWatch(const Robot& robot)
    : watched_(std::ranges::all_of(
          robot.joints,
          [](const JointConfig& joint) { return joint.rigid() || joint.torque_sensor.present; })),
      friction_Nm_(VectorJ::Zero(robot.size())),
      limit_Nm_(friction_Nm_),
      rate_Nm_per_s_(friction_Nm_),
      by_motor_(friction_Nm_),
      down_(Eigen::Map<const Eigen::Vector3d>(robot.gravity).normalized()),
      v_(friction_Nm_),
      r_(friction_Nm_),
      carried_(friction_Nm_),
      tau_(friction_Nm_),
      held_r_(friction_Nm_),
      scales_(robot.joints.size()) {
  Eigen::Index i = 0;
  for (const JointConfig& joint : robot.joints) {
    friction_Nm_[i] = friction_bound(joint);
    limit_Nm_[i] = joint.torque_limit_Nm;
    rate_Nm_per_s_[i] = joint.torque_rate_limit_Nm_per_s;
    by_motor_[i++] = joint.torque_sensor.present ? 0.0 : 1.0;
  }
}

int LoadWatch::wrong(const joint_state_t& state, const Model& model, double dt_s) noexcept {
  const bool held = time_s_ < kEnd_s;
  if (!watched_ || !(held || follows_scales())) {
    relax(dt_s);
    return -1;
  }
  observe(state, model, dt_s);
  if (!held) {
    *law_s_ += dt_s;
    follow(VectorJ::Zero(r_.size()), dt_s);
    if (*law_s_ >= kBegin_s) judge_scales(state, dt_s);
    return -1;
  }
  follow(r_, dt_s);
  if (time_s_ >= kBegin_s) hold_scales(state, model);
  const int joint = judge(model);
  wrong_s_ = joint < 0 ? 0.0 : wrong_s_ + dt_s;
  return time_s_ >= kBegin_s && wrong_s_ >= kLasting_s ? joint : -1;
}

// Only between two states without a gap is the change of speed what the torque has made.
bool LoadWatch::follows(const joint_state_t& state, double dt_s) noexcept {
  const bool before = answered_;
  const auto ages = std::span(state.age_cycles).first(static_cast<std::size_t>(r_.size()));
  answered_ = std::ranges::all_of(ages, [](int age) { return age == 0; });
  return before && answered_ && dt_s <= 1.5e-9 * static_cast<double>(state.period_ns);
}

void LoadWatch::observe(const joint_state_t& state, const Model& model, double dt_s) noexcept {
  const Eigen::Map<const VectorJ> v(state.v, r_.size());
  const Eigen::Map<const VectorJ> sensed(state.tau, r_.size());
  const Eigen::Map<const VectorJ> applied(state.tau_applied, r_.size());
  const bool follows_on = follows(state, dt_s);
  time_s_ += dt_s;
  const VectorJ dv = v - v_;
  v_ = v;
  if (!follows_on) return;
  const VectorJ tau = sensed + by_motor_.cwiseProduct(applied - sensed);
  const VectorJ gained = model.M * dv + by_motor_.cwiseProduct(model.B.cwiseProduct(dv));
  r_ += (gained - (tau - model.gravity - model.Cv + r_) * dt_s) / kMemory_s;
  tau_ += (tau - tau_) * dt_s / kMemory_s;
}

bool LoadWatch::follows_scales() const noexcept {
  return law_s_ && *law_s_ < kFollowed_s && std::ranges::any_of(scales_, &ScaleWatch::suspected);
}

void LoadWatch::hold_scales(const joint_state_t& state, const Model& model) noexcept {
  for (Eigen::Index i = 0; i < r_.size(); ++i) {
    ScaleWatch& joint = scales_[static_cast<std::size_t>(i)];
    joint.forget();
    if (by_motor_[i] > 0.0 && model.walls[i] == 0.0)
      joint.hold(seen(state, i), model.gravity[i], friction_Nm_[i]);
  }
  held_r_ = r_;
}

void LoadWatch::judge_scales(const joint_state_t& state, double dt_s) noexcept {
  for (Eigen::Index i = 0; i < r_.size(); ++i) {
    if (scales_[static_cast<std::size_t>(i)].overdriven(seen(state, i), dt_s))
      overdriven_ = static_cast<int>(i);
  }
}

int LoadWatch::judge(const Model& model) const noexcept {
  const VectorJ s = model.J.topRows<3>().transpose() * down_;
  const double weight_N = std::max(0.0, s.dot(r_) / std::max(s.squaredNorm(), 1e-9));
  for (Eigen::Index i = 0; i < r_.size(); ++i) {
    const double g = model.gravity[i];
    const double wall = model.walls[i];
    const double left = r_[i] - weight_N * s[i];
    const double unexplained = left - std::clamp(left, std::min(0.0, g) - std::max(0.0, wall),
                                                 std::max(0.0, g) - std::min(0.0, wall));
    const double most = friction_Nm_[i] + kModelShare * std::abs(g) + weight_N * kOffset;
    if (!(std::abs(unexplained) <= most)) return static_cast<int>(i);
  }
  return -1;
}

}  // namespace limber::controller
