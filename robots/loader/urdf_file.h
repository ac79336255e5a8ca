// A URDF file as XML, and what must not reach an XML parser at all.
#pragma once

#include <tinyxml2.h>

#include <memory>
#include <string>

namespace limber {

/// Reads and parses a file whose root is <robot>. Throws ConfigError. Refused without parsing: more
/// than 8 MiB, more than 10,000 elements, DOCTYPE and entities, xacro macros. Set-up only.
std::shared_ptr<const tinyxml2::XMLDocument> read_urdf_file(const std::string& path);

}  // namespace limber
