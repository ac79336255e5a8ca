#include "sim/hand/objects.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace limber::sim {
namespace {

constexpr double kAcceleration_s = 5e-3;

/// Of a point that goes with the tip.
Eigen::Vector3d velocity_at(const LinkDynamics& arm, const Eigen::Vector3d& p) noexcept {
  const int tip = arm.tip();
  return arm.link_velocity(tip) + arm.link_angular_velocity(tip).cross(p - arm.link_position(tip));
}

}  // namespace

Objects::Objects(const std::vector<ObjectConfig>& objects, const double p_TG[3],
                 const double gravity[3])
    : count_(std::min(objects.size(), kMostObjects)),
      p_TG_(Eigen::Map<const Eigen::Vector3d>(p_TG)),
      gravity_(Eigen::Map<const Eigen::Vector3d>(gravity)),
      down_(gravity_.stableNormalized()) {
  std::copy_n(objects.begin(), count_, configs_.begin());
  reset();
}

void Objects::reset() noexcept {
  states_.fill({});
  for (std::size_t i = 0; i < count_; ++i)
    states_[i].p = Eigen::Map<const Eigen::Vector3d>(configs_[i].p_B);
  between_ = kNone;
  held_ = moved_ = false;
}

/// Below the height at which it lay.
double Objects::depth(std::size_t i) const noexcept {
  return down_.dot(states_[i].p - Eigen::Map<const Eigen::Vector3d>(configs_[i].p_B));
}

double Objects::carried_share(std::size_t i) const noexcept {
  return std::clamp(-depth(i) / kLift_m, 0.0, 1.0);
}

double Objects::held_mass_kg() const noexcept {
  if (!held_) return 0.0;
  const auto i = static_cast<std::size_t>(between_);
  return carried_share(i) * configs_[i].mass_kg;
}

void Objects::step(const LinkDynamics& arm, double width, double force, double h) noexcept {
  const Eigen::Vector3d tip = arm.link_position(arm.tip()) + arm.link_rotation(arm.tip()) * p_TG_;
  find_between(tip, width);
  const Eigen::Vector3d at =
      between_ == kNone ? tip : states_[static_cast<std::size_t>(between_)].p;
  const Eigen::Vector3d v = velocity_at(arm, at);
  const double share = h / (kAcceleration_s + h);
  if (moved_) a_tip_ += share * ((v - v_tip_) / h - a_tip_);
  if (!moved_) a_tip_.setZero();
  v_tip_ = v;
  moved_ = true;
  for (std::size_t i = 0; i < count_; ++i) {
    if (static_cast<int>(i) == between_ && force > 0.0) {
      carry(arm, force, h);
    } else {
      if (static_cast<int>(i) == between_) held_ = false;
      fall(i, h);
    }
  }
}

void Objects::find_between(const Eigen::Vector3d& grasp_point, double width) noexcept {
  const auto distance = [&](std::size_t i) { return (states_[i].p - grasp_point).norm(); };
  if (between_ != kNone && !held_ && distance(static_cast<std::size_t>(between_)) > kReach_m) {
    states_[static_cast<std::size_t>(between_)].slips = false;
    between_ = kNone;
    moved_ = false;  // the velocity was that of another point
  }
  if (between_ != kNone) return;
  double nearest = kReach_m;
  for (std::size_t i = 0; i < count_; ++i) {
    if (distance(i) > nearest || width < configs_[i].width_m) continue;
    nearest = distance(i);
    between_ = static_cast<int>(i);
    moved_ = false;
  }
}

void Objects::carry(const LinkDynamics& arm, double force, double h) noexcept {
  const auto i = static_cast<std::size_t>(between_);
  State& object = states_[i];
  const double grip = 2.0 * configs_[i].friction * force / configs_[i].mass_kg;  // m/s^2
  const bool enough = grip >= carried_share(i) * (a_tip_ - gravity_).norm();
  if (held_) {
    object.p = arm.link_position(arm.tip()) + arm.link_rotation(arm.tip()) * p_TO_;
    object.v = v_tip_;
    held_ = enough;
    object.slips = !enough;
    return;
  }
  if (object.rests) {
    if (enough) hold(arm);
    return;
  }
  const Eigen::Vector3d v = object.v + h * gravity_;
  const Eigen::Vector3d behind = v_tip_ - v;
  if (enough && behind.norm() <= grip * h) return hold(arm);
  object.slips = true;
  object.v = v + h * grip * behind.stableNormalized();
  object.p += h * object.v;
  object.rests = depth(i) >= 0.0;
  if (object.rests) object.v.setZero();
}

void Objects::hold(const LinkDynamics& arm) noexcept {
  State& object = states_[static_cast<std::size_t>(between_)];
  p_TO_ = arm.link_rotation(arm.tip()).transpose() * (object.p - arm.link_position(arm.tip()));
  held_ = true;
  object.rests = object.slips = false;
}

void Objects::fall(std::size_t i, double h) noexcept {
  State& object = states_[i];
  object.slips = false;
  if (object.rests) return;
  object.v += h * gravity_;
  object.p += h * object.v;
  if (depth(i) < 0.0) return;
  object.rests = true;
  object.v.setZero();
}

}  // namespace limber::sim
