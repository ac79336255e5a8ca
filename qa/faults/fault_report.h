// What the driver makes of every fault, over families and phases, as JSON.
#pragma once

#include <string>

namespace limber::faults {

struct ReportOptions {
  int phases = 3;
  std::string fault;   ///< by its name; empty: all
  std::string place;   ///< only faults of this place; empty: all
  std::string family;  ///< only this protocol's; empty: all
  std::string traces;  ///< folder for one candump log a run, PROTOCOL-PHASE.log; empty: none
};

/// {"faults": [{"name", "place", "most_cycles", "watched_cycles", "from_start", "families":
/// {PROTOCOL: REACTION}}]}. A reaction has the members of Reaction, the worst over the phases of
/// the motion, with "cycles": [least, most], the robot's name and rate, the joint's and its bus's,
/// and "each": the reaction at each phase. Throws ConfigError for a word that is none.
std::string report_json(const ReportOptions& options);

/// {"faults": [{"name", "place", "families": [PROTOCOL, ..]}]}, without injecting any.
std::string list_json();

}  // namespace limber::faults
