// Frames of one CubeMars drive. Angles, speeds and torques are the drive's own, before sign and
// offset of robot.yaml.
#pragma once

#include "tools/can/dbc.h"
#include "tools/can/motors_on_bus.h"
#include "tools/can/reading.h"

namespace limber::bus_tools {

class CubemarsDecoder final : public FrameDecoder {
 public:
  explicit CubemarsDecoder(const Motor& motor) : name_(motor.name), drive_(motor.joint.drive) {}
  std::optional<Reading> read(const CanFrame& frame) override;

 private:
  Reading read_command(const CanFrame& frame) const;
  Reading read_state(const CanFrame& frame) const;

  std::string name_;
  DriveConfig drive_;
};

/// Commands, and one state of all motors that reply alike. Of a V3 none.
void add_cubemars_messages(const Motor& motor, const BusFacts& bus,
                           std::vector<dbc::Message>* messages);

}  // namespace limber::bus_tools
