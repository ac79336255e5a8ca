// Which identifiers on its bus a drive speaks or listens on.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "robots/robot.h"

namespace limber {

/// Damiao, moteus: command and reply. CiA 402: also network management, SYNC, and what its node
/// number reserves for emergencies, service data and heartbeat (CiA 301, predefined connection
/// set). A moteus drive listens besides to whatever ends in its number; see tip_sensor_yaml.cc.
inline bool uses_id(const DriveConfig& drive, std::uint32_t id) {
  if (id == drive.command_id || id == drive.reply_id) return true;
  if (drive.protocol != DriveProtocol::kCia402) return false;
  const std::uint32_t node = drive.command_id - 0x200U;
  const std::array<std::uint32_t, 6> reserved = {0x000U,        0x080U,        0x080U + node,
                                                 0x580U + node, 0x600U + node, 0x700U + node};
  return std::find(reserved.begin(), reserved.end(), id) != reserved.end();
}

}  // namespace limber
