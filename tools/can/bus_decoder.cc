#include "tools/can/bus_decoder.h"

#include "drivers/can/lockstep_frame.h"
#include "tools/can/canopen_decoder.h"
#include "tools/can/damiao_decoder.h"
#include "tools/can/error_text.h"
#include "tools/can/moteus_decoder.h"
#include "tools/can/motors_on_bus.h"
#include "tools/can/tip_sensor_decoder.h"

namespace limber::bus_tools {
namespace {

std::unique_ptr<FrameDecoder> make_decoder(const Motor& motor, const Robot& robot) {
  const DriveConfig& drive = motor.joint.drive;
  const bool fd = robot.buses[static_cast<std::size_t>(drive.bus)].fd;
  switch (drive.protocol) {
    case DriveProtocol::kMoteus:
      return std::make_unique<MoteusDecoder>(motor);
    case DriveProtocol::kCia402:
      return std::make_unique<CanopenDecoder>(motor, fd, 1.0 / robot.rate_hz);
    case DriveProtocol::kDamiaoMit:
      break;
  }
  return std::make_unique<DamiaoDecoder>(motor);
}

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
  std::map<std::uint8_t, std::string> nodes;
  std::vector<std::unique_ptr<FrameDecoder>> last;
  for (const Motor& motor : motors_on_bus(robot, bus)) {
    const DriveProtocol protocol = motor.joint.drive.protocol;
    if (protocol == DriveProtocol::kCia402)
      nodes[canopen::node_of(motor.joint.drive.command_id)] = motor.name;
    // moteus drives listen to seven bits of an identifier: those who know all of it come first.
    (protocol == DriveProtocol::kMoteus ? last : decoders_).push_back(make_decoder(motor, robot));
  }
  if (!nodes.empty()) decoders_.push_back(std::make_unique<CanopenNetworkDecoder>(nodes));
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
