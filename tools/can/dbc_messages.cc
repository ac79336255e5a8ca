#include "tools/can/dbc_messages.h"

#include <fmt/format.h>

#include <set>

#include "tools/can/dbc_signals.h"
#include "tools/can/drive_decoders.h"
#include "tools/can/tip_sensor_decoder.h"

namespace limber::bus_tools {
namespace {

/// A node's name that no other node has: "rot y" and "rot_y" are the same letters to a DBC file.
std::string take_node(const std::string& name, std::set<std::string>* taken) {
  const std::string wanted = dbc::identifier(name);
  std::string node = wanted;
  for (int number = 2; !taken->insert(node).second; ++number)
    node = fmt::format("{}_{}", wanted, number);
  return node;
}

}  // namespace

std::vector<dbc::Message> dbc_messages(const Robot& robot, int bus) {
  const BusFacts facts = facts_of(robot, bus);
  std::vector<dbc::Message> messages;
  std::set<std::string> nodes = {"limber", kAllNodes};
  std::set<const DriveDecoders*> families;
  for (Motor& motor : motors_on_bus(robot, bus)) {
    motor.node = take_node(motor.name, &nodes);
    const DriveDecoders& family = decoders_of(motor.joint.drive);
    family.add_messages(motor, facts, &messages);
    families.insert(&family);
  }
  for (const DriveDecoders* family : families) {
    if (family->add_network_messages != nullptr) family->add_network_messages(facts, &messages);
  }
  if (robot.has_tip_sensor && robot.tip_sensor.bus == bus)
    add_tip_sensor_messages(robot.tip_sensor, take_node("tip", &nodes), &messages);
  return messages;
}

}  // namespace limber::bus_tools
