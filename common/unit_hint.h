// The unit that a figure was probably written in, where it cannot be the one it is read in.
#pragma once

#include <string>

namespace limber {

/// "; are these millimetres? 0.3 m would be allowed": of a figure that is read in the unit its key
/// ends with (_m, _rad, _Nm, _s, ...) and lies outside `low` to `high`, if a usual multiple of that
/// unit brings it inside; else empty. Set-up only.
std::string unit_hint(const std::string& key, double value, double low, double high);

}  // namespace limber
