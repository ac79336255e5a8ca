// Where limber's own robots and scenarios are.
#pragma once

#include <string>

namespace limber {

/// PREFIX/share/limber for a program, or a library, in a folder of PREFIX: a build folder or what
/// was installed. Empty if there is none. Set-up only.
std::string shared_folder();

}  // namespace limber
