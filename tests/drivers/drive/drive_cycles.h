// Cycles of one drive: a command, the frames that come back, the close.
#pragma once

#include <vector>

#include "drivers/drive/drive.h"

namespace limber::testing {

/// Two cycles are bridged, 1000 cycles a second.
struct DriveCycles {
  explicit DriveCycles(const JointConfig& joint, bool fd = true) : drive(joint, fd, 1000.0, 2) {}

  void cycle(DriveState state, const std::vector<CanFrame>& frames) {
    drive.begin_cycle();
    drive.next_frame(state, 0.0, true);
    for (const CanFrame& frame : frames) drive.receive(state, frame);
    drive.close_cycle(state, number, 1e-3 * static_cast<double>(number));
    ++number;
  }

  Drive drive;
  std::int64_t number = 0;
};

}  // namespace limber::testing
