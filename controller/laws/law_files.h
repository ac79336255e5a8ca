// Laws from shared libraries.
#pragma once

#include <string>
#include <vector>

#include "controller/kinds/law_entry.h"

namespace limber::controller {

/// The laws of these files and of those that $LIMBER_LAWS names, ':' between them; by name, each
/// file once. A file belongs to root or to the user, nobody else may write it, and it was compiled
/// for this limber: else ConfigError, as for one that is no law. What is opened is never closed.
/// Set-up only.
std::vector<LawEntry> open_law_files(std::vector<std::string> files);

}  // namespace limber::controller
