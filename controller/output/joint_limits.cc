#include "controller/output/joint_limits.h"

#include <algorithm>
#include <cmath>
#include <limber/controller_status_t.hpp>
#include <string>

#include "common/config_error.h"
#include "controller/elastic/spring_law.h"

namespace limber::controller {
namespace {

constexpr double kWallWidth = 0.10;  // rad or m
constexpr double kWallShareOfRange = 0.1;
constexpr double kWallTorqueAtLimit = 0.5;  // share of the torque limit
constexpr double kWallDampingRatio = 0.7;
// Its natural frequency times the period: an answer that is two cycles old still damps.
constexpr double kWallTurnPerCycle_rad = 0.15;
constexpr double kLeadsOut = 0.1;    // rad/s or m/s
constexpr double kLeadsAhead = 0.1;  // of the wall
constexpr double kFadesFrom = 0.5;   // of the wall

template <typename Member>
VectorJ collect(const Robot& robot, Member member) {
  VectorJ values(robot.size());
  for (int i = 0; i < robot.size(); ++i)
    values[i] = robot.joints[static_cast<std::size_t>(i)].*member;
  return values;
}

VectorJ wall_widths(const Robot& robot) {
  const VectorJ range =
      collect(robot, &JointConfig::position_max) - collect(robot, &JointConfig::position_min);
  return (range * kWallShareOfRange).cwiseMin(kWallWidth);
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
    : wall_(wall_widths(robot)),
      place_{collect(robot, &JointConfig::position_min) + wall_,
             collect(robot, &JointConfig::position_max) - wall_},
      now_(place_),
      torque_rate_(collect(robot, &JointConfig::torque_rate_limit_Nm_per_s)),
      power_W_(robot.power_limit_W),
      limiter_(torque_limits(robot), kShareOfGateStep * torque_rate_),
      stopping_(robot, limiter_.torque()) {
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

JointLimits::InWall JointLimits::in_wall(const Edges& edges, double q, Eigen::Index i) noexcept {
  const double below = edges.low[i] - q;
  const double above = q - edges.high[i];
  return below > above ? InWall{below, -1.0} : InWall{above, 1.0};
}

void JointLimits::rest(const VectorJ& q) noexcept {
  now_.low = place_.low.cwiseMin(q);
  now_.high = place_.high.cwiseMax(q);
}

void JointLimits::lead_out(const VectorJ& q, double period_s) noexcept {
  const double step = kLeadsOut * period_s;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const double ahead = kLeadsAhead * wall_[i];
    const double low = std::min(now_.low[i] + step, std::max(q[i] + ahead, now_.low[i]));
    const double high = std::max(now_.high[i] - step, std::min(q[i] - ahead, now_.high[i]));
    now_.low[i] = std::min(low, place_.low[i]);
    now_.high[i] = std::max(high, place_.high[i]);
  }
}

VectorJ JointLimits::walls(const ArmState& state, const MatrixJ& M) const noexcept {
  VectorJ tau = VectorJ::Zero(state.q.size());
  for (Eigen::Index i = 0; i < tau.size(); ++i) {
    const auto [depth, outwards] = in_wall(now_, state.q[i], i);
    if (!(depth > 0.0)) continue;
    const bool rigid = rigid_[static_cast<std::size_t>(i)];
    const double v = rigid ? state.v_reported[i] : state.theta_dot_reported[i];
    const double speed = std::max(outwards * v, 0.0);
    const double K = std::min(kWallTorqueAtLimit * torque_limit()[i] / wall_[i],
                              std::pow(kWallTurnPerCycle_rad / state.period_s, 2) * M(i, i));
    // The damper comes in with the depth: at the edge of the wall nothing jumps.
    const double D =
        2.0 * kWallDampingRatio * std::sqrt(K * M(i, i)) * std::min(depth / wall_[i], 1.0);
    tau[i] = -outwards * (K * depth + D * speed);
  }
  return tau;
}

bool JointLimits::fade_at_ends(const ArmState& state, const VectorJ& g, const VectorJ& walls,
                               VectorJ* tau) const noexcept {
  bool acted = false;
  for (Eigen::Index i = 0; i < tau->size(); ++i) {
    const auto [depth, outwards] = in_wall(place_, state.q[i], i);
    const double fades = 1.0 - (1.0 - depth / wall_[i]) / (1.0 - kFadesFrom);
    const double pushing = (*tau)[i] - g[i] - walls[i];
    if (!(fades > 0.0 && pushing * outwards > 0.0)) continue;
    (*tau)[i] -= pushing * std::min(fades, 1.0);
    acted = true;
  }
  return acted;
}

std::int32_t JointLimits::shape(const ArmState& state, const ArmTerms& terms, const VectorJ& walls,
                                VectorJ* tau) const noexcept {
  std::int32_t acted = walls.isZero(0.0) ? 0 : controller_status_t::LIMIT_POSITION;
  if (scale_for_power(state.v_reported, terms.g, tau)) acted |= controller_status_t::LIMIT_POWER;
  if (fade_at_ends(state, terms.g, walls, tau)) acted |= controller_status_t::LIMIT_POSITION;
  return acted;
}

std::int32_t JointLimits::clamp(double period_s, VectorJ* tau) noexcept {
  const TorqueLimiter::Acted acted = limiter_.limit(period_s, tau);
  return (acted.torque ? controller_status_t::LIMIT_TORQUE : 0) |
         (acted.rate ? controller_status_t::LIMIT_RATE : 0);
}

std::int32_t JointLimits::clamp(const ArmState& state, const ArmTerms& terms,
                                VectorJ* tau) noexcept {
  const double T = state.period_s;
  const VectorJ& most = torque_limit();
  const VectorJ step = kShareFromApplied * T * torque_rate_;
  const VectorJ applied = state.tau_applied.cwiseMax(-most).cwiseMin(most);
  const auto near_applied = [&](const VectorJ& x) -> VectorJ {
    return x.cwiseMax(applied - step).cwiseMin(applied + step);
  };
  const auto [low, high] = limiter_.reach(T);
  const Stopping::Reach reach{near_applied(low), near_applied(high)};
  std::int32_t acted = clamp(T, tau);
  const VectorJ limited = near_applied(*tau);
  if (limited != *tau) acted |= controller_status_t::LIMIT_RATE;
  *tau = limited;
  stopping_.observe(state, terms);
  acted |= stopping_.shape(state, terms, reach, tau);
  limiter_.set_previous(*tau);
  return acted;
}

}  // namespace limber::controller
