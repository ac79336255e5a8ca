// Checks a YAML text before any tree is built from it.
#pragma once

#include <string>

namespace limber {

/// Throws ConfigError (file:line: ...) for what a configuration file has no use for and a reader
/// may stumble over: anchors, aliases and tags, a key twice in one mapping, keys that are not plain
/// words, nesting deeper than 12, more than one document, anything but a mapping at the top, broken
/// syntax.
void check_yaml_text(const std::string& text, const std::string& file);

}  // namespace limber
