#include "drivers/families/drive_codec.h"

#include <fmt/format.h>

#include <cmath>

namespace limber {

bool all_finite(const DriveCommand& command) noexcept {
  return std::isfinite(command.angle_rad) && std::isfinite(command.speed_rad_per_s) &&
         std::isfinite(command.kp_Nm_per_rad) && std::isfinite(command.kd_Nms_per_rad) &&
         std::isfinite(command.torque_Nm);
}

std::string DriveCodec::status_text(std::uint16_t status) const {
  return fmt::format("status 0x{:04X}", status);
}

std::string DriveCodec::emergency_text(std::uint16_t code) const {
  return fmt::format("emergency 0x{:04X}", code);
}

}  // namespace limber
