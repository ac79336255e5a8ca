// The arm that the running stack drives.
#pragma once

#include <string>

namespace limber {

/// Folder of the arm whose controller publishes ROBOT_INFO on this machine. `given`: a name or
/// folder that the user named, "" for none. Throws ConfigError if no controller answers and nothing
/// was given, or if the controller's arm is another one. Set-up only; waits up to 2 s.
std::string running_robot(const std::string& given);

}  // namespace limber
