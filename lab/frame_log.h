// Writes the frames of a lab's buses to a file in candump's log format, in arm time: a frame's own
// time where it has one (replies on the simulated wire), else that of its cycle's start.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "drivers/can/candump_log.h"
#include "lab/lab.h"

namespace limber {

class FrameLog {
 public:
  /// Listens from now on. Throws ConfigError if the file cannot be written.
  FrameLog(const std::string& path, const Robot& robot, Lab* lab);

  /// Everything since the last call, in order of time. Throws std::runtime_error when the disk
  /// refuses.
  void write_cycle(std::int64_t cycle_ns);
  void flush() { file_.flush(); }

 private:
  CandumpWriter file_;
  std::vector<std::string> interfaces_;
  std::vector<std::unique_ptr<CanBus>> ends_;
  std::vector<LoggedFrame> frames_;
};

}  // namespace limber
