// A CAN bus between processes of one host without any CAN in the kernel: UDP multicast in
// python-can's format.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "drivers/can/can_bus.h"

namespace limber {

/// Joins the bus `name` (see open_can_bus); python-can joins it with
///   can.Bus(interface="udp_multicast", channel=virtual_bus_group(name), port=43113, hop_limit=0)
/// Frames stay on this host (TTL 0). There is no bit rate and no arbitration, and frames of
/// different senders may overtake one another. FD frames are ignored unless `fd`. Throws
/// ConfigError with the two commands that make a multicast route where there is none. Set-up only.
std::unique_ptr<CanBus> open_virtual_bus(const std::string& name, bool fd,
                                         Stamps stamps = Stamps::kOnArrival);

/// Multicast group of a bus: "default" is python-can's 239.74.163.2, a multicast address is itself,
/// and another name of letters, digits, '-' and '_' is 239.74.H1.H0 with the two low bytes of H = h
/// ^ (h >> 16), h = FNV-1a (32 bit) of the name. Throws ConfigError. Set-up only.
std::string virtual_bus_group(const std::string& name);

/// UDP port of all virtual buses: 43113, or $LIMBER_VIRTUAL_BUS_PORT. Throws ConfigError. Set-up
/// only.
std::uint16_t virtual_bus_port();

}  // namespace limber
