// A CAN interface of the Linux kernel: real adapters, vcan and vxcan alike.
#pragma once

#include <memory>
#include <string>

#include "drivers/can/can_bus.h"

namespace limber {

/// Opens an interface for classic frames, and FD frames too if `fd`. Foreign frames and the
/// controller's error frames are received, our own are not. Throws ConfigError with the command
/// that helps: no AF_CAN in this kernel, no such interface, not a CAN interface, down, or no FD.
/// Set-up only.
///
/// Afterwards nothing is fatal. A full transmit queue or a link that is down drops the frame
/// (`send_refused`); `link_down` follows the interface, `bus_off` the controller's error frames. A
/// bus-off controller is never restarted from here: that is for the interface's restart-ms or for a
/// person. An interface that was removed is waited for, by a thread of the bus, ten times a second:
/// once one of that name is there again and up, frames flow again; its bit rate is not compared.
/// `unsent` is what the kernel's queue still holds (SO_MEMINFO; CAN sockets have no SIOCOUTQ);
/// frames that the adapter has taken, but nobody acknowledges, are not in it.
std::unique_ptr<CanBus> open_socketcan(const std::string& interface, bool fd);

}  // namespace limber
