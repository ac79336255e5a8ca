// Frames of one moteus drive: rows of register writes, reads and answers, whoever is the host.
// Angles, speeds and torques are the drive's own, in turns of its output.
#pragma once

#include "drivers/protocols/moteus_frame.h"
#include "tools/can/dbc.h"
#include "tools/can/motors_on_bus.h"
#include "tools/can/reading.h"

namespace limber::bus_tools {

struct MoteusRegisterText {
  std::string name;
  std::string unit;
};
/// "register 123h" without a unit for those without a name.
MoteusRegisterText moteus_register(std::uint16_t reg);

class MoteusDecoder final : public FrameDecoder {
 public:
  explicit MoteusDecoder(const Motor& motor);
  std::optional<Reading> read(const CanFrame& frame) override;

 private:
  std::string name_;
  std::uint8_t id_;
};

void add_moteus_messages(const Motor& motor, const BusFacts& bus,
                         std::vector<dbc::Message>* messages);

}  // namespace limber::bus_tools
