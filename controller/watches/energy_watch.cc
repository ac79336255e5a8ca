#include "controller/watches/energy_watch.h"

#include <algorithm>
#include <limits>

namespace limber::controller {
namespace {

bool seen(const JointConfig& joint) { return joint.rigid() || joint.link_encoder.present; }

}  // namespace

EnergyWatch::EnergyWatch(const Robot& robot)
    : limit_J_(std::ranges::all_of(robot.joints, seen) ? robot.energy_limit_J
                                                       : std::numeric_limits<double>::infinity()) {
  for (const JointConfig& joint : robot.joints) sprung_.push_back(!joint.rigid());
}

EnergyWatch::Cycle EnergyWatch::cycle(const joint_state_t& state,
                                      const Model& model) const noexcept {
  const auto n = model.g.size();
  const VectorJ v = Eigen::Map<const VectorJ>(state.v, n);
  VectorJ w = v;
  for (Eigen::Index i = 0; i < n; ++i)
    if (sprung_[static_cast<std::size_t>(i)]) w[i] = state.theta_dot[i];
  const double kinetic_J = 0.5 * (v.dot(model.M * v) + w.dot(model.B.cwiseProduct(w)));
  return {v, w, model.tau_s, kinetic_J};
}

bool EnergyWatch::exceeded(const joint_state_t& state, const Model& model, double dt_s) noexcept {
  if (limit_J_ == std::numeric_limits<double>::infinity()) return false;
  const Cycle now = cycle(state, model);
  if (last_) {
    const Eigen::Map<const VectorJ> tau(state.tau_applied, model.g.size());
    const VectorJ tau_s = 0.5 * (last_->tau_s + now.tau_s);
    const double work_J =
        0.5 * dt_s *
        ((last_->w + now.w).dot(tau - tau_s) + (last_->v + now.v).dot(tau_s - model.g));
    const double kept = std::max(0.0, 1.0 - dt_s / kMemory_s);
    const double given_J = now.kinetic_J - last_->kinetic_J - work_J;
    unexplained_J_ = std::max(0.0, kept * unexplained_J_ + given_J);
  }
  last_ = now;
  const bool within = std::min(now.kinetic_J, unexplained_J_) <= limit_J_;
  cycles_ = within ? 0 : cycles_ + 1;
  return cycles_ >= kCycles;
}

}  // namespace limber::controller
