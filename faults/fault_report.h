// What the driver makes of every fault, over families and phases, as JSON.
#pragma once

#include <string>

namespace limber::faults {

/// {"faults": [{"name", "most_cycles", "watched_cycles", "from_start", "families": {PROTOCOL:
/// REACTION}}]}. A reaction has the members of Reaction, the worst over `phases` phases of the
/// motion, with "cycles": [least, most], and the robot's name and rate, the joint's and its bus's.
/// `name`: one fault only, empty: all. Throws ConfigError for a name that is none.
std::string report_json(int phases, const std::string& name);

}  // namespace limber::faults
