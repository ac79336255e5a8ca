#include "robots/address_yaml.h"

#include <fmt/format.h>

#include <algorithm>

namespace limber {
namespace {

void read_damiao(const YamlMap& yaml, DriveConfig* drive) {
  // The reply carries the identifier in four bits.
  drive->command_id = static_cast<std::uint32_t>(yaml.integer("id", 1, 15));
  drive->reply_id = static_cast<std::uint32_t>(yaml.integer("reply_id", 1, 0x7FE));
  if (drive->reply_id == drive->command_id) yaml.refuse("reply_id", "must differ from id");
}

void read_moteus(const YamlMap& yaml, const Robot& robot, JointConfig* joint) {
  DriveConfig& drive = joint->drive;
  const BusConfig& bus = robot.buses[static_cast<std::size_t>(drive.bus)];
  if (!bus.fd)
    yaml.refuse("bus",
                fmt::format("'{}' is classic; moteus drives need CAN-FD (fd: true)", bus.name));
  if (joint->type == JointType::kPrismatic)
    yaml.refuse("motor", "moteus drives count turns: they can only move rotary joints");
  if (yaml.has("reply_id"))
    yaml.refuse("reply_id", "is for motors with protocol: damiao_mit only; the id says it here");
  const auto id = static_cast<std::uint32_t>(yaml.integer("id", 1, 126));
  drive.command_id = 0x8000U | id;
  drive.reply_id = id << 8U;
}

void check_free(const YamlMap& yaml, const Robot& robot, std::size_t index) {
  const DriveConfig& mine = robot.joints[index].drive;
  for (std::size_t i = 0; i < index; ++i) {
    const DriveConfig& other = robot.joints[i].drive;
    if (other.bus != mine.bus) continue;
    const std::string taken = fmt::format("is taken by {} on the same bus", robot.joints[i].name);
    if (other.command_id == mine.command_id || other.reply_id == mine.command_id)
      yaml.refuse("id", fmt::format("{} {}", yaml.integer("id", 1, 126), taken));
    if (other.command_id == mine.reply_id || other.reply_id == mine.reply_id)
      yaml.refuse("reply_id", fmt::format("{} {}", mine.reply_id, taken));
  }
}

}  // namespace

void read_address(const YamlMap& yaml, const Robot& robot, std::size_t index, JointConfig* joint) {
  std::vector<std::string> names;
  for (const BusConfig& bus : robot.buses) names.push_back(bus.name);
  const std::string bus = yaml.word("bus", names);
  joint->drive.bus = static_cast<int>(std::find(names.begin(), names.end(), bus) - names.begin());
  if (joint->drive.protocol == DriveProtocol::kMoteus) {
    read_moteus(yaml, robot, joint);
  } else {
    read_damiao(yaml, &joint->drive);
  }
  check_free(yaml, robot, index);
}

}  // namespace limber
