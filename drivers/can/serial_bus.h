// CAN adapters on a serial line, without a driver in the kernel.
#pragma once

#include <memory>
#include <string>

#include "common/can_address.h"
#include "drivers/can/can_bus.h"

namespace limber {

/// `text`: the address, for messages. Classic frames only. Throws ConfigError: see
/// open_serial_port(); an adapter that refuses to open, a bit rate that it has not. Set-up only.
///
/// Afterwards nothing is fatal. A frame that the line does not take, and one that the adapter
/// reports as not sent, count as `send_refused`; a frame of which a part has been written is
/// completed first, so that the adapter keeps in step. `unsent` is what the line still holds.
/// Damaged answers count as `malformed`. A line that goes is `link_down`; a thread of the bus opens
/// it again ten times a second. Frames bear the time at which they are read.
std::unique_ptr<CanBus> open_serial_bus(const std::string& text, const CanAddress& line, bool fd,
                                        int bitrate_bps);

}  // namespace limber
