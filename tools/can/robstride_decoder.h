// Frames of one RobStride drive. Angles, speeds and torques are the drive's own, before sign and
// offset of robot.yaml.
#pragma once

#include "tools/can/dbc.h"
#include "tools/can/motors_on_bus.h"
#include "tools/can/reading.h"

namespace limber::bus_tools {

class RobstrideDecoder final : public FrameDecoder {
 public:
  explicit RobstrideDecoder(const Motor& motor) : name_(motor.name), drive_(motor.joint.drive) {}
  std::optional<Reading> read(const CanFrame& frame) override;

 private:
  Reading read_command(const CanFrame& frame) const;
  Reading read_reply(const CanFrame& frame) const;

  std::string name_;
  DriveConfig drive_;
};

/// The state of a drive that runs without a fault. A command has its torque in the identifier, for
/// which the format has no words.
void add_robstride_messages(const Motor& motor, const BusFacts& bus,
                            std::vector<dbc::Message>* messages);

}  // namespace limber::bus_tools
