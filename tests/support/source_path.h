// Where the sources lie that a test reads.
#pragma once

#include <string>

namespace limber {

/// Of a file or folder of the tree, by its path from the top. The folder of the tree is compiled
/// into one object, so that a compiler cache serves the other objects of a test in any clone.
std::string source_path(const std::string& from_top);

}  // namespace limber
