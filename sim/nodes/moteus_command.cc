#include "sim/nodes/moteus_command.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace limber::sim {

using moteus::Register;

const MoteusCommand::Values& MoteusCommand::defaults() noexcept {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  // position, velocity, torque, kp scale, kd scale, most torque, stop position, watchdog, limits of
  // velocity and acceleration
  static constexpr Values kDefaults = {kNan, 0.0, 0.0, 1.0, 1.0, kNan, kNan, 0.0, kNan, kNan};
  return kDefaults;
}

void MoteusCommand::set(std::uint16_t reg, double value) noexcept {
  const std::size_t i = index(static_cast<Register>(reg));
  const auto which = static_cast<Register>(reg);
  if (which == Register::kCommandWatchdog) {
    values_[i] = value;  // NaN: none
  } else if (!std::isfinite(value)) {
    values_[i] = defaults()[i];
  } else if (which == Register::kCommandKpScale || which == Register::kCommandKdScale) {
    values_[i] = std::clamp(value, 0.0, 1.0);
  } else {
    values_[i] = value;
  }
}

}  // namespace limber::sim
