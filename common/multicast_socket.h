// UDP multicast between the processes of one machine: the virtual CAN buses and the arm plane.
#pragma once

#include <netinet/in.h>

#include <span>
#include <string>
#include <string_view>

#include "common/file_descriptor.h"

namespace limber {

/// What makes a multicast route on a machine that has none, as for a user to type.
inline constexpr const char* kMulticastRouteCommands =
    "sudo ip link set lo multicast on && sudo ip route add 224.0.0.0/4 dev lo";

/// Both do not block.
struct MulticastSockets {
  FileDescriptor receiver;  ///< hears what others send to the group, not what `sender` sends
  FileDescriptor sender;    ///< for sendto() the group
};

/// Joins `group` on the interface to which the kernel routes it, where `sender` sends as well, at
/// most `ttl` hops far, with a receive buffer of `buffer_bytes` (receive_buffer.h). Throws
/// ConfigError that begins with `name`, without a route with kMulticastRouteCommands. Set-up only.
MulticastSockets open_multicast(const std::string& name, const sockaddr_in& group, int ttl,
                                int buffer_bytes);

/// The receiver alone, which hears everybody in the group. Throws ConfigError likewise. Set-up
/// only.
FileDescriptor open_multicast_receiver(const std::string& name, const sockaddr_in& group,
                                       int buffer_bytes);

/// From here on `receiver` hears LCM's short messages on these channels alone; the kernel drops all
/// others before they wake anybody up. `sender`'s it still does not hear. Throws ConfigError that
/// begins with `name`. Set-up only.
void hear_only(const std::string& name, const MulticastSockets& sockets,
               std::span<const std::string_view> channels);

/// The network interface to which this machine routes `group`, and where sockets join it. "" if it
/// is the loopback interface, or if there is no route. Set-up only.
std::string network_interface_of(const in_addr& group);

}  // namespace limber
