// Where a joint's drive is on the buses: the keys bus, id and reply_id of a joint.
#pragma once

#include <cstddef>

#include "common/yaml_reader.h"
#include "robots/robot.h"

namespace limber {

/// Sets bus and identifiers of `drive`, whose protocol is known: a motor of robot.joints[index].
/// The joints before it are set, and the first motor if this is the antagonist. Throws ConfigError:
/// identifiers the protocol does not have or that are taken, a bus that cannot carry the drive's
/// frames. Set-up only.
///
/// damiao_mit: id 1 to 15 and reply_id, as they are on the bus.
/// moteus: id 1 to 126. On the bus the command is 0x8000 | id, from host 0 with an answer wanted,
/// and the answer id << 8.
/// cia402: node id 1 to 127. RPDO 1 to the drive is 0x200 + id, TPDO 1 from it 0x180 + id.
void read_address(const YamlMap& yaml, const Robot& robot, std::size_t index, DriveConfig* drive);

}  // namespace limber
