// MyActuator drives: motion mode, orders for the start-up.
#pragma once

#include "drivers/families/drive_family.h"

namespace limber {

/// `period_s`: of the commands.
std::unique_ptr<DriveCodec> myactuator_codec(const JointConfig& joint, double period_s);
std::unique_ptr<StartupDialogue> myactuator_startup(const JointConfig& joint);
std::unique_ptr<IntruderRules> myactuator_intruders(const JointConfig& joint);

/// The motor's number, of its command's identifier.
inline int myactuator_number(const DriveConfig& drive) noexcept {
  return static_cast<int>(drive.command_id & 0x3FU);
}

}  // namespace limber
