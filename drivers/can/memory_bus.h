// A CAN bus inside one process: for the lab and for unit tests. Deterministic, single-threaded,
// allocates only in the constructor.
#pragma once

#include <memory>
#include <vector>

#include "drivers/can/can_bus.h"

namespace limber {

/// Owns the bus; ends are created with `attach`. A frame sent by one end reaches every other end,
/// in order. A queue that is full drops the new frame and counts it at the receiving end
/// (`overflow`).
class MemoryBus {
 public:
  explicit MemoryBus(int queue_frames = 256);
  ~MemoryBus();

  /// A new end of this bus; lives no longer than the bus.
  std::unique_ptr<CanBus> attach();

 private:
  class End;
  int queue_frames_;
  std::vector<End*> ends_;
};

}  // namespace limber
