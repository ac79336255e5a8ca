// Frames of the force/torque sensor at the tip: as it sends them, bias and tool not taken out.
#pragma once

#include "robots/loader/robot.h"
#include "tools/can/dbc.h"
#include "tools/can/reading.h"

namespace limber::bus_tools {

class TipSensorDecoder final : public FrameDecoder {
 public:
  explicit TipSensorDecoder(const TipSensorConfig& sensor) : sensor_(sensor) {}
  std::optional<Reading> read(const CanFrame& frame) override;

 private:
  std::optional<Reading> read_limber_ft(const CanFrame& frame) const;
  std::optional<Reading> read_robotous(const CanFrame& frame);

  TipSensorConfig sensor_;
  std::optional<CanFrame> first_half_;  ///< kRobotousRft
};

/// `node`: its name in the DBC file.
void add_tip_sensor_messages(const TipSensorConfig& sensor, const std::string& node,
                             std::vector<dbc::Message>* messages);

}  // namespace limber::bus_tools
