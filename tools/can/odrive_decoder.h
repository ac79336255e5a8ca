// Frames of one ODrive axis, in the motor's turns and torques as on the bus.
#pragma once

#include "tools/can/dbc.h"
#include "tools/can/motors_on_bus.h"
#include "tools/can/reading.h"

namespace limber::bus_tools {

class OdriveDecoder final : public FrameDecoder {
 public:
  explicit OdriveDecoder(const Motor& motor)
      : name_(motor.name), node_(motor.joint.drive.command_id >> 5U) {}
  std::optional<Reading> read(const CanFrame& frame) override;

 private:
  std::string name_;
  std::uint32_t node_;
};

void add_odrive_messages(const Motor& motor, const BusFacts& bus,
                         std::vector<dbc::Message>* messages);

}  // namespace limber::bus_tools
