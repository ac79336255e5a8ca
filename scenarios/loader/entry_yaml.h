// One entry of a scenario's timeline: `at_s` and exactly one thing that happens then.
#pragma once

#include "common/yaml_reader.h"
#include "lcmtypes/gains_table.h"
#include "scenarios/loader/scenario.h"

namespace limber {

/// What an entry is read against.
struct EntryContext {
  const LoadedRobot& robot;
  /// nullptr: gains are left to the controller and not read.
  const LawCatalog* laws;
  double duration_s;
};

/// Reads and checks one entry; messages are without seq, which is given when the timeline is
/// sorted. Empty where the entry is left to another process. Set-up only.
std::optional<TimedMessage> read_entry(const YamlMap& yaml, const EntryContext& context);

/// A request on behalf of the scenario.
mode_request_t mode_request(int request);

}  // namespace limber
