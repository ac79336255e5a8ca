// Whether a text is XML, judged by the parser that the Python tools read it with.
#pragma once

#include <string>

namespace limber {

/// Line of a place in a text, from 1 on.
int line_at(const std::string& text, std::size_t position);

/// Throws ConfigError with file and line unless `text` is well-formed XML 1.0 in UTF-8. A declared
/// encoding other than UTF-8 is fine as long as all characters are ASCII. Prefixes need no
/// declaration: they mark what is somebody's extension. Set-up only.
void check_xml_text(const std::string& text, const std::string& path);

}  // namespace limber
