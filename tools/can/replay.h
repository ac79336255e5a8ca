// Sends the frames of a recording again.
#pragma once

#include <csignal>
#include <cstdint>
#include <string>

#include "robots/loader/robot.h"

namespace limber::bus_tools {

struct ReplayOptions {
  std::string file;
  bool force = false;  ///< also on buses that are not virtual
  std::string only;    ///< "commands" or "replies" as robot.yaml has them; empty: all
};

struct ReplayCount {
  std::int64_t sent = 0;
  std::int64_t left_out = 0;  ///< error frames, and what `only` leaves out
  std::int64_t refused = 0;   ///< by the bus
};

/// At the pace of the recording; a time that goes back is no wait. The file is read to its end
/// before the first frame leaves. Throws ConfigError, also if a bus may carry an arm and `force` is
/// not given.
ReplayCount replay(const Robot& robot, const ReplayOptions& options,
                   const volatile std::sig_atomic_t& stop);

}  // namespace limber::bus_tools
