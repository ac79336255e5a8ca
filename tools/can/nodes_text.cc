#include "tools/can/nodes_text.h"

#include <fmt/format.h>

#include "drivers/can/can_frame.h"
#include "drivers/can/candump_log.h"
#include "drivers/can/virtual_bus.h"
#include "robots/loader/protocols/drive_protocol.h"
#include "tools/can/motors_on_bus.h"
#include "tools/can/reading.h"

namespace limber::bus_tools {
namespace {

std::string id_text(std::uint32_t id) { return hex(id, id > kStandardIdMax ? 8 : 3); }

std::string bit_rates(const BusConfig& bus) {
  if (!bus.fd) return fmt::format("classic CAN, {:g} Mbit/s", 1e-6 * bus.bitrate_bps);
  return fmt::format("CAN-FD, {:g} and {:g} Mbit/s", 1e-6 * bus.bitrate_bps,
                     1e-6 * bus.data_bitrate_bps);
}

std::string python_can(const BusConfig& bus) {
  const std::string fd = bus.fd ? ", fd=True" : "";
  const std::string name = candump_interface(bus.can);
  const std::optional<CanAddress> address = can_address(bus.can);
  if (address && address->carrier == CanCarrier::kDamiaoSerial) return "no interface of its own";
  if (address && address->carrier == CanCarrier::kSlcan)
    return fmt::format("can.Bus(interface=\"slcan\", channel=\"{}\")", name);
  if (!is_virtual(bus.can))
    return fmt::format("can.Bus(interface=\"socketcan\", channel=\"{}\"{})", name, fd);
  return fmt::format("can.Bus(interface=\"udp_multicast\", channel=\"{}\", port={}, hop_limit=0{})",
                     virtual_bus_group(name), virtual_bus_port(), fd);
}

std::string row(const std::string& who, const std::string& what, std::string_view protocol,
                std::uint32_t command_id, const std::string& reply_ids) {
  return fmt::format("  {:<18} {:<20} {:<13} {:>8} {:>9}\n", who, what, protocol,
                     id_text(command_id), reply_ids);
}

std::string bus_text(const Robot& robot, int index) {
  const BusConfig& bus = robot.buses[static_cast<std::size_t>(index)];
  std::string text = fmt::format("bus {}: {}, {}\n  python-can joins it with {}\n", bus.name,
                                 bus.can, bit_rates(bus), python_can(bus));
  text += fmt::format("  {:<18} {:<20} {:<13} {:>8} {:>9}\n", "joint", "motor", "protocol",
                      "command", "reply");
  for (const Motor& motor : motors_on_bus(robot, index)) {
    const DriveConfig& drive = motor.joint.drive;
    text += row(motor.name, drive.motor, drive.protocol->word, drive.command_id,
                id_text(drive.reply_id));
  }
  if (robot.has_tip_sensor && robot.tip_sensor.bus == index) {
    const TipSensorConfig& sensor = robot.tip_sensor;
    std::string replies = id_text(sensor.reply_ids[0]);
    if (sensor.replies() > 1) replies += " " + id_text(sensor.reply_ids[1]);
    text += row("tip", sensor.model, traits_of(sensor.protocol).word, sensor.command_id, replies);
  }
  return text;
}

}  // namespace

std::string nodes_text(const Robot& robot) {
  std::string text;
  for (int bus = 0; bus < static_cast<int>(robot.buses.size()); ++bus) text += bus_text(robot, bus);
  return text;
}

}  // namespace limber::bus_tools
