// Frames of one Damiao drive: MIT commands and states, special frames, registers. Angles, speeds
// and torques are the drive's own, before sign and offset of robot.yaml.
#pragma once

#include <span>

#include "drivers/protocols/mit.h"
#include "tools/can/dbc.h"
#include "tools/can/motors_on_bus.h"
#include "tools/can/reading.h"

namespace limber::bus_tools {

class DamiaoDecoder final : public FrameDecoder {
 public:
  explicit DamiaoDecoder(const Motor& motor) : name_(motor.name), drive_(motor.joint.drive) {}
  std::optional<Reading> read(const CanFrame& frame) override;

 private:
  Reading read_command(const CanFrame& frame) const;
  Reading read_servo(const CanFrame& frame, mit::ControlMode mode) const;
  Reading read_request(const mit::RegisterRequest& request);
  Reading read_reply(const CanFrame& frame);
  std::optional<Reading> read_register(const CanFrame& frame);

  std::string name_;
  DriveConfig drive_;
  /// The request not answered yet: an answer looks like a state, and is one if nobody asked.
  std::optional<mit::RegisterRequest> open_;
};

/// A register of the maker's manual.
struct DamiaoRegister {
  std::uint8_t number;
  const char* name;
  bool whole;  ///< uint32, else float32
  const char* unit;
};
/// All that have a name here.
std::span<const DamiaoRegister> damiao_registers() noexcept;
/// A register by its name in the maker's manual, with unit; by its number if it is not listed.
Value damiao_register(std::uint8_t reg, std::uint32_t raw);

void add_damiao_messages(const Motor& motor, const BusFacts& bus,
                         std::vector<dbc::Message>* messages);
/// Requests of registers, under an identifier that all drives share.
void add_damiao_registers(const BusFacts& bus, std::vector<dbc::Message>* messages);

}  // namespace limber::bus_tools
