// RobStride drives in their private protocol.
#pragma once

#include "drivers/families/drive_family.h"

namespace limber {

std::unique_ptr<DriveCodec> robstride_codec(const JointConfig& joint);
std::unique_ptr<StartupDialogue> robstride_startup(const JointConfig& joint);
std::unique_ptr<IntruderRules> robstride_intruders(const JointConfig& joint);

/// The motor's number, of its command's identifier.
inline std::uint8_t robstride_number(const DriveConfig& drive) noexcept {
  return static_cast<std::uint8_t>(drive.command_id & 0x7FU);
}

}  // namespace limber
