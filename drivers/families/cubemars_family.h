// CubeMars AK drives in MIT mode, of boards V1, V2 and V3: nothing of theirs can be read or set.
#pragma once

#include "drivers/families/drive_family.h"

namespace limber {

std::unique_ptr<DriveCodec> cubemars_codec(const JointConfig& joint);
std::unique_ptr<StartupDialogue> cubemars_startup(const JointConfig& joint);
std::unique_ptr<IntruderRules> cubemars_intruders(const JointConfig& joint);

}  // namespace limber
