#include "robots/address_yaml.h"

#include <fmt/format.h>

#include <algorithm>

#include "robots/drive_ids.h"

namespace limber {
namespace {

void read_damiao(const YamlMap& yaml, DriveConfig* drive) {
  // The reply carries the identifier in four bits.
  drive->command_id = static_cast<std::uint32_t>(yaml.integer("id", 1, 15));
  drive->reply_id = static_cast<std::uint32_t>(yaml.integer("reply_id", 1, 0x7FE));
  if (drive->reply_id == drive->command_id) yaml.refuse("reply_id", "must differ from id");
}

const char* word_of(DriveProtocol protocol) {
  return protocol == DriveProtocol::kMoteus ? "moteus" : "cia402";
}

void need_fd(const YamlMap& yaml, const Robot& robot, const DriveConfig& drive) {
  const BusConfig& bus = robot.buses[static_cast<std::size_t>(drive.bus)];
  if (bus.fd) return;
  yaml.refuse("bus", fmt::format("'{}' is classic; {} drives need CAN-FD (fd: true)", bus.name,
                                 word_of(drive.protocol)));
}

void read_numbered(const YamlMap& yaml, const Robot& robot, JointType type, DriveConfig* drive) {
  need_fd(yaml, robot, *drive);
  if (type == JointType::kPrismatic) {
    yaml.refuse("motor", fmt::format("{} drives count turns: they can only move rotary joints",
                                     word_of(drive->protocol)));
  }
  if (yaml.has("reply_id"))
    yaml.refuse("reply_id", "is for motors with protocol: damiao_mit only; the id says it here");
  const bool moteus = drive->protocol == DriveProtocol::kMoteus;
  const auto id = static_cast<std::uint32_t>(yaml.integer("id", 1, moteus ? 126 : 127));
  drive->command_id = moteus ? 0x8000U | id : 0x200U + id;
  drive->reply_id = moteus ? id << 8U : 0x180U + id;
}

void refuse_same(const YamlMap& yaml, const DriveConfig& mine, const DriveConfig& other,
                 const std::string& owner) {
  if (other.bus != mine.bus) return;
  const std::string taken = fmt::format("is taken by {} on the same bus", owner);
  const long id = yaml.integer("id", 1, 127);
  if (uses_id(other, mine.command_id)) yaml.refuse("id", fmt::format("{} {}", id, taken));
  const bool reply_taken = uses_id(other, mine.reply_id);
  if (reply_taken && yaml.has("reply_id"))
    yaml.refuse("reply_id", fmt::format("{} {}", mine.reply_id, taken));
  if (reply_taken || uses_id(mine, other.command_id) || uses_id(mine, other.reply_id))
    yaml.refuse("id", fmt::format("{}: one of its identifiers {}", id, taken));
}

void check_free(const YamlMap& yaml, const Robot& robot, std::size_t index,
                const DriveConfig& mine) {
  for (std::size_t i = 0; i <= index; ++i) {
    const JointConfig& joint = robot.joints[i];
    if (&joint.drive != &mine && (i < index || &joint.antagonist == &mine))
      refuse_same(yaml, mine, joint.drive, joint.name);
    if (joint.has_antagonist && &joint.antagonist != &mine)
      refuse_same(yaml, mine, joint.antagonist, joint.name);
  }
}

}  // namespace

void read_address(const YamlMap& yaml, const Robot& robot, std::size_t index, DriveConfig* drive) {
  std::vector<std::string> names;
  for (const BusConfig& bus : robot.buses) names.push_back(bus.name);
  const bool antagonist = drive == &robot.joints[index].antagonist;
  const std::string bus =
      antagonist ? yaml.word_or("bus", names, names[static_cast<std::size_t>(drive->bus)])
                 : yaml.word("bus", names);
  drive->bus = static_cast<int>(std::find(names.begin(), names.end(), bus) - names.begin());
  if (drive->protocol == DriveProtocol::kDamiaoMit) {
    read_damiao(yaml, drive);
  } else {
    read_numbered(yaml, robot, robot.joints[index].type, drive);
  }
  check_free(yaml, robot, index, *drive);
}

}  // namespace limber
