// The state of the drives in a line of a log.
#pragma once

#include <string>

namespace limber {

/// `state`: DRIVE_* of joint_state_t; `fault`: FAULT_*; `joint`: name of the one that caused it, or
/// empty; `detail`: ArmDriver::fault_text(). Begins with "warning: " if somebody has to look.
/// Allocates.
std::string drives_text(int state, int fault, const std::string& joint, const std::string& detail);

/// The same of a later state, with a fault that has been told.
std::string drives_text_again(int state, int fault);

}  // namespace limber
