#include "controller/output/joint_limits.h"

#include <algorithm>
#include <cmath>
#include <limber/controller_status_t.hpp>
#include <string>

#include "common/config_error.h"
#include "controller/elastic/spring_law.h"

namespace limber::controller {
namespace {

constexpr double kVelocityScaledFrom = 0.8;
constexpr double kWallWidth = 0.10;  // rad or m
constexpr double kWallShareOfRange = 0.1;
constexpr double kWallTorqueAtLimit = 0.5;  // share of the torque limit
constexpr double kWallDampingRatio = 0.7;

template <typename Member>
VectorJ collect(const Robot& robot, Member member) {
  VectorJ values(robot.size());
  for (int i = 0; i < robot.size(); ++i)
    values[i] = robot.joints[static_cast<std::size_t>(i)].*member;
  return values;
}

// Two motors have to hold their preload besides.
VectorJ torque_limits(const Robot& robot) {
  VectorJ limits = collect(robot, &JointConfig::torque_limit_Nm);
  for (int i = 0; i < robot.size(); ++i) {
    const JointConfig& joint = robot.joints[static_cast<std::size_t>(i)];
    if (!joint.has_antagonist) continue;
    const double both = 2.0 * std::min(joint.drive.peak_torque_Nm, joint.antagonist.peak_torque_Nm);
    const SpringPair pair{joint.transmission.spring};
    const double left = both - pair.preload_torque(joint.transmission.preload_rad, 0.0);
    if (!(left > 0.0)) {
      throw ConfigError(robot.name + ": joint " + joint.name +
                        ": its motors cannot hold preload_rad: together they have " +
                        std::to_string(both) + " N m, the springs take " +
                        std::to_string(both - left));
    }
    limits[i] = std::min(limits[i], left);
  }
  return limits;
}

}  // namespace

JointLimits::JointLimits(const Robot& robot)
    : position_min_(collect(robot, &JointConfig::position_min)),
      position_max_(collect(robot, &JointConfig::position_max)),
      wall_(((position_max_ - position_min_) * kWallShareOfRange).cwiseMin(kWallWidth)),
      velocity_(collect(robot, &JointConfig::velocity_limit)),
      torque_rate_(collect(robot, &JointConfig::torque_rate_limit_Nm_per_s)),
      power_W_(robot.power_limit_W),
      limiter_(torque_limits(robot), kShareOfGateStep * torque_rate_) {
  for (const JointConfig& joint : robot.joints) rigid_.push_back(joint.rigid());
}

void JointLimits::set_previous(const VectorJ& tau) noexcept {
  limiter_.set_previous(tau.cwiseMax(-torque_limit()).cwiseMin(torque_limit()));
}

bool JointLimits::far_from_previous(const VectorJ& tau, double period_s) const noexcept {
  return ((tau - previous()).cwiseAbs().array() > torque_rate_.array() * period_s).any();
}

bool JointLimits::scale_for_power(const VectorJ& v, const VectorJ& g, VectorJ* tau) const noexcept {
  const double weight = g.dot(v);
  const double motion = tau->dot(v) - weight;
  if (!(motion > 0.0 && motion + weight > power_W_)) return false;
  const double share = std::max((power_W_ - weight) / motion, 0.0);  // below 1
  *tau = g + share * (*tau - g);
  return true;
}

bool JointLimits::scale_for_velocity(const ArmState& state, const VectorJ& g,
                                     VectorJ* tau) const noexcept {
  bool acted = false;
  for (Eigen::Index i = 0; i < tau->size(); ++i) {
    const double excess = std::abs(state.v[i]) / velocity_[i] - kVelocityScaledFrom;
    const double motion = (*tau)[i] - g[i];
    if (excess <= 0.0 || motion * state.v[i] <= 0.0) continue;
    (*tau)[i] = g[i] + motion * std::max(1.0 - excess / (1.0 - kVelocityScaledFrom), 0.0);
    acted = true;
  }
  return acted;
}

bool JointLimits::add_walls(const ArmState& state, const MatrixJ& M, VectorJ* tau) const noexcept {
  bool acted = false;
  for (Eigen::Index i = 0; i < tau->size(); ++i) {
    const double below = position_min_[i] + wall_[i] - state.q[i];
    const double above = state.q[i] - (position_max_[i] - wall_[i]);
    const double depth = std::max(below, above);
    if (!(depth > 0.0)) continue;
    const double outwards = below > above ? -1.0 : 1.0;
    const double v = rigid_[static_cast<std::size_t>(i)] ? state.v[i] : state.theta_dot[i];
    const double speed = std::max(outwards * v, 0.0);
    const double K = kWallTorqueAtLimit * torque_limit()[i] / wall_[i];
    // The damper comes in with the depth: at the edge of the wall nothing jumps.
    const double D =
        2.0 * kWallDampingRatio * std::sqrt(K * M(i, i)) * std::min(depth / wall_[i], 1.0);
    (*tau)[i] -= outwards * (K * depth + D * speed);
    acted = true;
  }
  return acted;
}

std::int32_t JointLimits::shape(const ArmState& state, const ArmTerms& terms,
                                VectorJ* tau) const noexcept {
  std::int32_t acted = 0;
  if (scale_for_power(state.v, terms.g, tau)) acted |= controller_status_t::LIMIT_POWER;
  if (scale_for_velocity(state, terms.g, tau)) acted |= controller_status_t::LIMIT_VELOCITY;
  if (add_walls(state, terms.M_total, tau)) acted |= controller_status_t::LIMIT_POSITION;
  return acted;
}

std::int32_t JointLimits::clamp(double period_s, VectorJ* tau) noexcept {
  const TorqueLimiter::Acted acted = limiter_.limit(period_s, tau);
  return (acted.torque ? controller_status_t::LIMIT_TORQUE : 0) |
         (acted.rate ? controller_status_t::LIMIT_RATE : 0);
}

std::int32_t JointLimits::clamp(double period_s, const VectorJ& applied, VectorJ* tau) noexcept {
  std::int32_t acted = clamp(period_s, tau);
  for (Eigen::Index i = 0; i < tau->size(); ++i) {
    const double step = kShareFromApplied * torque_rate_[i] * period_s;
    const double from = std::clamp(applied[i], -torque_limit()[i], torque_limit()[i]);
    const double limited = std::clamp((*tau)[i], from - step, from + step);
    if (limited != (*tau)[i]) acted |= controller_status_t::LIMIT_RATE;
    (*tau)[i] = limited;
  }
  limiter_.set_previous(*tau);
  return acted;
}

}  // namespace limber::controller
