// XML, by the parser that the Python tools edit and draw it with, too.
#pragma once

#include <string>

#include "robots/loader/xml_element.h"

namespace limber {

/// Line of a place in a text, from 1 on.
int line_at(const std::string& text, std::size_t position);

/// The root. Throws ConfigError with file and line unless `text` is well-formed XML 1.0 in UTF-8,
/// with elements at most 100 deep. A declared encoding other than UTF-8 is fine as long as all
/// characters are ASCII. Prefixes need no declaration: they mark what is somebody's extension.
/// Set-up only.
XmlElement parse_xml(const std::string& text, const std::string& path);

}  // namespace limber
