// Other masters on the bus: which frames of theirs command a drive or write its settings, and which
// answers of the drive are for them. One class a family, one object a drive. Allowed in the cycle.
#pragma once

#include "drivers/can/can_frame.h"

namespace limber {

class IntruderRules {
 public:
  virtual ~IntruderRules() = default;

  /// Start of a cycle.
  virtual void begin_cycle() noexcept {}
  /// Whether a frame of another sender commands this drive or writes its settings: it must not go
  /// unnoticed.
  virtual bool is_foreign_command(const CanFrame& frame) const noexcept = 0;
  /// A frame of another sender: the answer to a request in it is not for this driver.
  virtual void record_foreign(const CanFrame& frame) noexcept { static_cast<void>(frame); }
  /// True if the frame answers what record_foreign() has kept, once for each.
  virtual bool answers_foreign(const CanFrame& frame) noexcept {
    static_cast<void>(frame);
    return false;
  }
};

}  // namespace limber
