// CANopen drives with profile CiA 402 in cyclic synchronous torque mode. At the SYNC a drive
// executes its command (RPDO1) and sends its state (TPDO1, and those that follow it).
#pragma once

#include "drivers/families/drive_family.h"

namespace limber {

std::unique_ptr<DriveCodec> cia402_codec(const JointConfig& joint, bool fd);
std::unique_ptr<StartupDialogue> cia402_startup(const JointConfig& joint, bool fd, double period_s);
std::unique_ptr<IntruderRules> cia402_intruders(const JointConfig& joint);

}  // namespace limber
