// The keys that every robot.yaml has to have, those of its drives' protocols among them: checked
// here, and written into robots/README.md.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/yaml_reader.h"

namespace limber {

struct RequiredKey {
  const char* section;    ///< "" for the top, "motors.*" for each motor, ...
  const char* key;        ///< alternatives separated by |: one of them has to be there
  std::string_view only;  ///< a protocol, or "fd: true"; "": always
  std::string what;       ///< what it is
};

/// In the order of the file.
const std::vector<RequiredKey>& required_keys();

/// Throws ConfigError with every required key that is missing, one a line. Values are not looked
/// at. Set-up only.
void check_required_keys(const YamlMap& yaml);

/// The table in Markdown.
std::string required_keys_table();

}  // namespace limber
