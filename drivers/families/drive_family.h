// One drive at the driver's end: its bytes, its start-up, and the rules for other masters.
#pragma once

#include <memory>

#include "drivers/families/drive_codec.h"
#include "drivers/families/intruder_rules.h"
#include "drivers/families/startup_dialogue.h"
#include "robots/loader/robot.h"

namespace limber {

struct DriveFamily {
  std::unique_ptr<DriveCodec> codec;
  std::unique_ptr<StartupDialogue> startup;
  std::unique_ptr<IntruderRules> intruders;
};

/// The family that the joint's drive belongs to. `fd`: its bus carries FD frames; `period_s`: of
/// the commands. Set-up only.
DriveFamily make_drive_family(const JointConfig& joint, bool fd, double period_s);

}  // namespace limber
