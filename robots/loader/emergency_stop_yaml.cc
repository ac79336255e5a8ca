#include "robots/loader/emergency_stop_yaml.h"

#include <fmt/format.h>

#include <algorithm>

#include "robots/loader/address_yaml.h"
#include "robots/loader/protocols/drive_protocol.h"

namespace limber {
namespace {

void check_free(const YamlMap& yaml, const EmergencyStopConfig& stop, const Robot& robot) {
  for (const JointConfig& joint : robot.driven()) {
    for (int motor = 0; motor < joint.motors(); ++motor) {
      const DriveConfig& drive = joint.motor(motor);
      if (drive.bus == stop.bus && (uses_id(drive, stop.id) || accepts_id(drive, stop.id)))
        yaml.refuse("id", fmt::format("{} is taken by {} on the same bus", stop.id, joint.name));
    }
  }
  if (!robot.has_tip_sensor || robot.tip_sensor.bus != stop.bus) return;
  const TipSensorConfig& sensor = robot.tip_sensor;
  const auto* replies_end = sensor.reply_ids.begin() + sensor.replies();
  if (stop.id == sensor.command_id ||
      std::find(sensor.reply_ids.begin(), replies_end, stop.id) != replies_end)
    yaml.refuse("id", fmt::format("{} is taken by the tip sensor on the same bus", stop.id));
}

}  // namespace

void read_emergency_stop(const YamlMap& yaml, Robot* robot) {
  EmergencyStopConfig stop;
  stop.bus = read_bus(yaml, *robot);
  stop.id = static_cast<std::uint32_t>(yaml.integer("id", 1, kMostId));
  stop.byte = static_cast<int>(yaml.integer_or("byte", 0, 7, stop.byte));
  stop.mask = static_cast<std::uint8_t>(yaml.integer_or("mask", 1, 255, stop.mask));
  stop.released = static_cast<std::uint8_t>(yaml.integer_or("released", 0, 255, stop.mask));
  stop.timeout_s = yaml.number_or("timeout_s", {0.005, 1.0}, stop.timeout_s);
  stop.power_off_s = yaml.number_or("power_off_s", {0.0, 10.0}, stop.power_off_s);
  if ((stop.released & ~stop.mask) != 0) {
    yaml.refuse("released",
                fmt::format("{} has bits that mask {} leaves out; it could never be seen",
                            stop.released, stop.mask));
  }
  check_free(yaml, stop, *robot);
  yaml.finish();
  robot->emergency_stop = stop;
}

}  // namespace limber
