// Where a joint's drive is on the buses: the keys bus, id and, for some protocols, reply_id.
#pragma once

#include <cstddef>
#include <optional>

#include "common/yaml_reader.h"
#include "robots/loader/robot.h"

namespace limber {

/// The key `bus`: index of the bus that it names; of `otherwise` if there is no such key. Throws
/// ConfigError for a name that is none. Set-up only.
int read_bus(const YamlMap& yaml, const Robot& robot, std::optional<int> otherwise = std::nullopt);

/// Sets bus and identifiers of `drive`, whose protocol is known: a motor of robot.joints[index].
/// The joints before it are set, and the first motor if this is the antagonist. Throws ConfigError:
/// identifiers the protocol does not have or that are taken, a bus that cannot carry the drive's
/// frames. Which identifiers a protocol has is in protocols/. Set-up only.
void read_address(const YamlMap& yaml, const Robot& robot, std::size_t index, DriveConfig* drive);

}  // namespace limber
