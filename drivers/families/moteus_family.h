// moteus drives: registers over CAN-FD, everything in each cycle's frame.
#pragma once

#include "drivers/families/drive_family.h"

namespace limber {

std::unique_ptr<DriveCodec> moteus_codec(const JointConfig& joint);
std::unique_ptr<StartupDialogue> moteus_startup(const JointConfig& joint);
std::unique_ptr<IntruderRules> moteus_intruders(const JointConfig& joint);

}  // namespace limber
