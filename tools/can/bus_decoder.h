// Reads every frame of one bus of an arm.
#pragma once

#include <memory>
#include <vector>

#include "robots/loader/robot.h"
#include "tools/can/reading.h"

namespace limber::bus_tools {

class BusDecoder {
 public:
  BusDecoder(const Robot& robot, int bus);
  /// Frames in the order of the bus: some can only be read after another one.
  Reading read(const CanFrame& frame);

 private:
  std::vector<std::unique_ptr<FrameDecoder>> decoders_;
};

}  // namespace limber::bus_tools
