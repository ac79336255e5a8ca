#include "drivers/can/error_frame.h"

#include <linux/can/error.h>

namespace limber {

void count_error_frame(const CanFrame& frame, CanStatistics* statistics) noexcept {
  ++statistics->error_frames;
  const bool active_again =
      (frame.id & CAN_ERR_CRTL) != 0 && (frame.data[1] & CAN_ERR_CRTL_ACTIVE) != 0;
  if ((frame.id & CAN_ERR_RESTARTED) != 0 || active_again) statistics->bus_off = false;
  if ((frame.id & CAN_ERR_BUSOFF) != 0) statistics->bus_off = true;
}

}  // namespace limber
