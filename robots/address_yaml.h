// Where a joint's drive is on the buses: the keys bus, id and reply_id of a joint.
#pragma once

#include <cstddef>

#include "common/yaml_reader.h"
#include "robots/robot.h"

namespace limber {

/// Sets bus and identifiers of joint->drive, whose protocol is known; `index` is the joint's place
/// in robot.joints, and those before it are set. Throws ConfigError: identifiers the protocol does
/// not have or that are taken, a bus that cannot carry the drive's frames. Set-up only.
///
/// damiao_mit: id 1 to 15 and reply_id, as they are on the bus.
/// moteus: id 1 to 126. On the bus the command is 0x8000 | id, from host 0 with an answer wanted,
/// and the answer id << 8.
void read_address(const YamlMap& yaml, const Robot& robot, std::size_t index, JointConfig* joint);

}  // namespace limber
