// A URDF file as XML, and what must not reach an XML parser at all.
#pragma once

#include <string>

#include "robots/loader/xml_element.h"

namespace limber {

/// The root of a file, <robot>. Throws ConfigError. Refused without parsing: more
/// than 8 MiB, more than 10,000 elements, DOCTYPE and entities, xacro macros. Set-up only.
XmlElement read_urdf_file(const std::string& path);

}  // namespace limber
