#include "sim/nodes/setpoint_profile.h"

#include <algorithm>
#include <cmath>

namespace limber::sim {

void SetpointProfile::start(double position, double velocity) noexcept {
  goal_ = {};
  position_ = position;
  velocity_ = velocity;
  complete_ = true;
}

void SetpointProfile::aim(const ProfileGoal& goal) noexcept {
  goal_ = goal;
  goal_.velocity = within_limit(goal.velocity);
  complete_ = std::isnan(goal.velocity_limit) && std::isnan(goal.acceleration_limit);
  if (!complete_) return;
  velocity_ = goal.velocity;
  if (!std::isnan(goal.position)) position_ = goal.position;
}

void SetpointProfile::advance(double seconds) noexcept {
  if (!(seconds > 0.0)) return;
  if (complete_) {
    position_ += velocity_ * seconds;
  } else if (std::isnan(goal_.position)) {
    change_speed(seconds);
  } else {
    approach(seconds);
  }
}

void SetpointProfile::keep_within(double least, double greatest) noexcept {
  const double before = position_;
  if (position_ < least) position_ = least;
  if (position_ > greatest) position_ = greatest;
  const bool limited = !std::isnan(goal_.velocity_limit) || !std::isnan(goal_.acceleration_limit);
  if (position_ != before && limited) complete_ = false;
}

double SetpointProfile::within_limit(double velocity) const noexcept {
  const double limit = std::abs(goal_.velocity_limit);
  return std::isnan(limit) ? velocity : std::clamp(velocity, -limit, limit);
}

void SetpointProfile::change_speed(double seconds) noexcept {
  const double before = velocity_;
  const double most = std::abs(goal_.acceleration_limit) * seconds;
  const double change = goal_.velocity - before;
  velocity_ = std::abs(change) > most ? before + std::copysign(most, change) : goal_.velocity;
  position_ += 0.5 * (before + velocity_) * seconds;
  complete_ = velocity_ == goal_.velocity;
}

/// Seen from the goal, which may move: the speed from which the setpoint still stops there, or the
/// limit if that is less.
void SetpointProfile::approach(double seconds) noexcept {
  const double most = std::abs(goal_.acceleration_limit) * seconds;
  const double before = velocity_;
  const double way = goal_.position - position_;
  goal_.position += goal_.velocity * seconds;
  if (std::isnan(most)) {
    velocity_ = within_limit(std::copysign(std::abs(goal_.velocity_limit), way));
    position_ += velocity_ * seconds;
    complete_ = (goal_.position - position_) * way <= 0.0;
  } else {
    // From the speed after this step the setpoint still stops within the way that is left then.
    const double speed = std::copysign(1.0, way) * (before - goal_.velocity);
    const double left = std::max(0.0, std::abs(way) - 0.5 * speed * seconds);
    const double braking = std::sqrt(0.25 * most * most + 2.0 * left * most / seconds) - 0.5 * most;
    const double wanted = within_limit(goal_.velocity + std::copysign(braking, way));
    velocity_ = before + std::clamp(wanted - before, -most, most);
    position_ += 0.5 * (before + velocity_) * seconds;
    complete_ = std::abs(goal_.position - position_) <= most * seconds &&
                std::abs(velocity_ - goal_.velocity) <= most;
  }
  if (!complete_) return;
  position_ = goal_.position;
  velocity_ = goal_.velocity;
}

}  // namespace limber::sim
