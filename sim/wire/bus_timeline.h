// The traffic of one cycle, frame by frame, before there is any: for pictures of a bus.
#pragma once

#include <string>
#include <vector>

#include "robots/loader/robot.h"

namespace limber::sim {

/// s after the start of the cycle, when the driver hands its frames to the adapter.
struct FrameTimes {
  std::string name;  ///< of the joint, "SYNC" or "tip sensor"
  std::uint32_t id = 0;
  bool reply = false;
  double start_s = 0.0;  ///< on the wire
  double end_s = 0.0;
};

/// One cycle of a bus on the simulated wire, without jitter: commands in the order of the joints,
/// replies when identifiers let them through. Data are typical, lengths and identifiers exact.
/// Set-up only.
std::vector<FrameTimes> bus_timeline(const Robot& robot, int bus);

}  // namespace limber::sim
