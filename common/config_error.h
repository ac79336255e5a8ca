// The one exception for everything that is wrong before a process runs: files, arguments, machine.
#pragma once

#include <stdexcept>
#include <string>

namespace limber {

/// What is wrong, where, and what would be right. Thrown during set-up only, caught in main(),
/// printed as one line, exit status 2. Never thrown inside the control cycle.
class ConfigError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;

  /// "FILE:LINE: KEY: VALUE: PROBLEM" with the parts that are known (line 0 and empty strings are
  /// left out).
  static ConfigError at(const std::string& file, int line, const std::string& key,
                        const std::string& problem);
};

}  // namespace limber
