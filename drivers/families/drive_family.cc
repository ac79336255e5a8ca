#include "drivers/families/drive_family.h"

#include <fmt/format.h>

#include <cmath>

namespace limber {

bool all_finite(const DriveCommand& command) noexcept {
  return std::isfinite(command.angle_rad) && std::isfinite(command.speed_rad_per_s) &&
         std::isfinite(command.kp_Nm_per_rad) && std::isfinite(command.kd_Nms_per_rad) &&
         std::isfinite(command.torque_Nm);
}

std::string DriveFamily::status_text(std::uint16_t status) const {
  return fmt::format("status 0x{:04X}", status);
}

std::string DriveFamily::describe(const StartupFailure& failure) const {
  if (failure.reg == 0) return "could not be disabled, or does not answer";
  if (failure.answer == Answer::kNone) return fmt::format("register {} not answered", failure.reg);
  return fmt::format("register {} is {:g}, expected {:g}", failure.reg, failure.found,
                     failure.expected);
}

}  // namespace limber
