#include "robots/loader/address_yaml.h"

#include <fmt/format.h>

#include <algorithm>

#include "robots/loader/protocols/drive_protocol.h"

namespace limber {
namespace {

/// Bus and joint must fit the protocol.
void check_protocol(const YamlMap& yaml, const DriveProtocol& protocol, const BusConfig& bus,
                    JointType type) {
  if (protocol.needs_fd && !bus.fd) {
    yaml.refuse("bus", fmt::format("'{}' is classic; {} drives need CAN-FD (fd: true)", bus.name,
                                   protocol.word));
  }
  if (protocol.rotary_only && type == JointType::kPrismatic) {
    yaml.refuse("motor", fmt::format("{} drives count turns: they can only move rotary joints",
                                     protocol.word));
  }
  refuse_foreign_keys(yaml, protocol);
}

// Drives of one family may share identifiers, such as CANopen's SYNC. Longer ones than of 11 bits
// carry their family.
bool families_share_id(const DriveConfig& one, const DriveConfig& other) {
  if (one.protocol == other.protocol) return false;
  for (std::uint32_t id = 0; id <= 0x7FF; ++id) {
    if (uses_id(one, id) && uses_id(other, id)) return true;
  }
  return false;
}

// Frames that one drive is sent, and the other takes for its own.
void refuse_orders(const YamlMap& yaml, const DriveConfig& sent, const DriveConfig& taking,
                   const std::string& owner) {
  if (sent.protocol == nullptr || sent.protocol->setting == nullptr) return;
  const std::uint32_t id = sent.protocol->setting(sent).request_id;
  if (!accepts_id(taking, id)) return;
  yaml.refuse("bus",
              fmt::format("frames {:X}h, by which settings of {} drives are read, are orders "
                          "to every {} drive on the same bus ({}): a bus for each",
                          id, sent.protocol->title, taking.protocol->title, owner));
}

void refuse_same(const YamlMap& yaml, const DriveConfig& mine, const DriveConfig& other,
                 const std::string& owner) {
  if (other.bus != mine.bus) return;
  const std::string taken = fmt::format("is taken by {} on the same bus", owner);
  const long id = yaml.integer("id", 1, 127);
  if (uses_id(other, mine.command_id)) yaml.refuse("id", fmt::format("{} {}", id, taken));
  const bool shared = other.protocol == mine.protocol && mine.protocol->shares_reply_id &&
                      mine.reply_id == other.reply_id;
  const bool reply_taken = !shared && uses_id(other, mine.reply_id);
  if (reply_taken && yaml.has("reply_id"))
    yaml.refuse("reply_id", fmt::format("{} {}", mine.reply_id, taken));
  if (reply_taken || families_share_id(mine, other) || uses_id(mine, other.command_id) ||
      (!shared && uses_id(mine, other.reply_id)))
    yaml.refuse("id", fmt::format("{}: one of its identifiers {}", id, taken));
  refuse_orders(yaml, mine, other, owner);
  refuse_orders(yaml, other, mine, owner);
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

int read_bus(const YamlMap& yaml, const Robot& robot, std::optional<int> otherwise) {
  std::vector<std::string> names;
  for (const BusConfig& bus : robot.buses) names.push_back(bus.name);
  const std::string name =
      otherwise ? yaml.word_or("bus", names, names[static_cast<std::size_t>(*otherwise)])
                : yaml.word("bus", names);
  return static_cast<int>(std::ranges::find(names, name) - names.begin());
}

void read_address(const YamlMap& yaml, const Robot& robot, std::size_t index, DriveConfig* drive) {
  const bool antagonist = drive == &robot.joints[index].antagonist;
  drive->bus = read_bus(yaml, robot, antagonist ? std::optional(drive->bus) : std::nullopt);
  check_protocol(yaml, *drive->protocol, robot.buses[static_cast<std::size_t>(drive->bus)],
                 robot.joints[index].type);
  drive->protocol->read_ids(yaml, drive);
  check_free(yaml, robot, index, *drive);
}

}  // namespace limber
