// What has to hold for every control law, tried on one from a shared library.
#pragma once

#include <string>

namespace limber {

/// Tries the law of `file` (controller/laws/law_plugin.h) on random arms of 1 to 16 joints with
/// random poses, gains and goals. A table with one line a rule; `passed`: all of them hold. A law
/// that throws ends the program with a message. Throws ConfigError if the file is no law.
std::string check_law_file(const std::string& file, bool* passed);

}  // namespace limber
