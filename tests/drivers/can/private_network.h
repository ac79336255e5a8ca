// A network of the test's own, so that multicast works on any machine and meets nobody else's.
#pragma once

namespace limber::testing {

/// Moves the process, and the programs it starts, into a new network namespace with a loopback
/// interface and, if wanted, a multicast route. Stays in the host's network where neither root nor
/// user namespaces are allowed. Call it before the first thread and socket. Returns whether the
/// network is private.
bool enter_private_network(bool multicast_route = true);

}  // namespace limber::testing
