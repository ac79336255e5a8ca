// Frames of one MyActuator drive. Angles, speeds and torques are the drive's own, before sign and
// offset of robot.yaml.
#pragma once

#include "tools/can/dbc.h"
#include "tools/can/motors_on_bus.h"
#include "tools/can/reading.h"

namespace limber::bus_tools {

class MyactuatorDecoder final : public FrameDecoder {
 public:
  explicit MyactuatorDecoder(const Motor& motor) : name_(motor.name), drive_(motor.joint.drive) {}
  std::optional<Reading> read(const CanFrame& frame) override;

 private:
  Reading read_order(const CanFrame& frame, Direction direction) const;

  std::string name_;
  DriveConfig drive_;
};

/// Motion commands and their answers.
void add_myactuator_messages(const Motor& motor, const BusFacts& bus,
                             std::vector<dbc::Message>* messages);

}  // namespace limber::bus_tools
