// Drives that know a single turn count from there when they are switched on: a joint that was
// parked more than half a turn from the drive's zero then reads a whole turn off.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "robots/loader/robot.h"

namespace limber {

/// How far beyond its travel a joint may read, rad (m): a stop gives way.
inline constexpr double kBeyondTravel = 0.02;

struct WholeTurns {
  int turns = 0;                       ///< to be added to what the drive reads: -1, 0 or 1
  bool known = true;                   ///< false: several are within the travel
  std::array<double, 2> candidates{};  ///< the first two of them, rad
};

/// The one of theta, theta + 2 pi and theta - 2 pi that lies in the joint's travel; theta itself if
/// none does, which is then out of range. Allowed inside the cycle.
inline WholeTurns whole_turns(double theta, const JointConfig& joint) noexcept {
  const bool bounded = std::isfinite(joint.position_min) && std::isfinite(joint.position_max);
  const bool turns_about = joint.type == JointType::kRevolute && !joint.has_antagonist;
  if (!joint.drive.single_turn || !turns_about || !bounded) return {};
  WholeTurns found;
  int fitting = 0;
  for (const int turns : {0, 1, -1}) {
    const double angle = theta + 2.0 * std::numbers::pi * turns;
    if (!(angle >= joint.position_min - kBeyondTravel &&
          angle <= joint.position_max + kBeyondTravel))
      continue;
    if (fitting < 2) found.candidates[static_cast<std::size_t>(fitting)] = angle;
    if (fitting++ == 0) found.turns = turns;
  }
  found.known = fitting <= 1;
  if (!found.known) found.turns = 0;
  return found;
}

}  // namespace limber
