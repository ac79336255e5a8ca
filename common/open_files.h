// How many files a process may open.
#pragma once

namespace limber {

/// Throws ConfigError unless there may be enough for any program here: one that has none left fails
/// in the middle. Set-up only.
void require_open_files();

}  // namespace limber
