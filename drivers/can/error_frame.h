// Error frames: what an adapter reports about its bus. The identifier holds class bits, CAN_ERR_*
// of linux/can/error.h on every carrier.
#pragma once

#include "drivers/can/can_bus.h"

namespace limber {

/// Counts a received error frame and follows bus-off and recovery. Allowed in the cycle.
void count_error_frame(const CanFrame& frame, CanStatistics* statistics) noexcept;

}  // namespace limber
