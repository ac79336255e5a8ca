// What a name may consist of.
#pragma once

#include <string>

namespace limber {

/// What is wrong with the name of a robot, a bus or a scenario, which becomes part of file names,
/// titles and pages: a letter or digit, then letters, digits, blanks, `_`, `.` and `-`, at most 64.
/// Empty if it is fine. `limber.model.names` has the same rule for Python.
std::string name_problem(const std::string& name);

/// The same of a link or joint of a URDF, which only has to be shown: text of up to 128 bytes
/// without control characters.
std::string shown_name_problem(const std::string& name);

}  // namespace limber
