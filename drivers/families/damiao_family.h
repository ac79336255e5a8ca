// Damiao drives: MIT frames, registers for the start-up.
#pragma once

#include "drivers/families/drive_family.h"

namespace limber {

std::unique_ptr<DriveCodec> damiao_codec(const JointConfig& joint, bool fd);
std::unique_ptr<StartupDialogue> damiao_startup(const JointConfig& joint, bool fd);
std::unique_ptr<IntruderRules> damiao_intruders(const JointConfig& joint);

}  // namespace limber
