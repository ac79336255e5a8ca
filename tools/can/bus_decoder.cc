#include "tools/can/bus_decoder.h"

#include <map>

#include "drivers/can/lockstep_frame.h"
#include "tools/can/drive_decoders.h"
#include "tools/can/error_text.h"
#include "tools/can/motors_on_bus.h"
#include "tools/can/tip_sensor_decoder.h"

namespace limber::bus_tools {
namespace {

std::optional<Reading> read_lockstep(const CanFrame& frame) {
  const bool tick = lockstep::is_tick(frame);
  if (!tick && !lockstep::is_tock(frame)) return std::nullopt;
  return Reading{"all",
                 tick ? Direction::kCommand : Direction::kReply,
                 tick ? "TICK" : "TOCK",
                 {{"cycle", std::to_string(lockstep::sequence(frame)), ""}}};
}

}  // namespace

BusDecoder::BusDecoder(const Robot& robot, int bus) {
  if (robot.has_tip_sensor && robot.tip_sensor.bus == bus)
    decoders_.push_back(std::make_unique<TipSensorDecoder>(robot.tip_sensor));
  std::map<const DriveDecoders*, std::vector<Motor>> families;
  std::vector<std::unique_ptr<FrameDecoder>> last;
  for (const Motor& motor : motors_on_bus(robot, bus)) {
    const DriveDecoders& family = decoders_of(motor.joint.drive);
    (family.last ? last : decoders_).push_back(family.make(motor, facts_of(robot, bus)));
    families[&family].push_back(motor);
  }
  for (const auto& [family, motors] : families) {
    if (family->make_network != nullptr) decoders_.push_back(family->make_network(motors));
  }
  for (auto& decoder : last) decoders_.push_back(std::move(decoder));
}

Reading BusDecoder::read(const CanFrame& frame) {
  if (frame.error) return {"-", Direction::kError, "error frame", error_values(frame)};
  if (auto reading = read_lockstep(frame)) return *reading;
  for (const auto& decoder : decoders_) {
    if (auto reading = decoder->read(frame)) return *reading;
  }
  return {"-", Direction::kForeign, "frame", {{"", bytes(frame), ""}}};
}

}  // namespace limber::bus_tools
