// Addresses of LCM planes: what is allowed, and whether others on the network can send to them.
#pragma once

#include <string>

namespace limber {

/// `url` with a 2 MiB receive buffer. Allowed is udpm://[GROUP:PORT] with at most one `ttl`, which
/// is 0 unless LIMBER_ALLOW_REMOTE=1 is set: messages stay on this machine. Throws ConfigError.
/// Set-up only.
std::string checked_lcm_url(const std::string& url);

/// The error message for a machine without a multicast route.
std::string no_multicast_route(const std::string& url);

/// $LIMBER_ARM_URL or the arm plane's address of the channel table; $LCM_DEFAULT_URL or the user
/// plane's.
std::string arm_plane_url();
std::string user_plane_url();

/// A ttl of 0 bounds what goes out, not what comes in: LCM joins its group on the interface to
/// which this machine routes multicast. The name of that interface if it is not the loopback
/// interface, "" if it is, or if there is no route. Set-up only.
std::string network_interface_of(const std::string& url);

/// Others on the network could send to `url`: throws ConfigError with the command that prevents it
/// if `moves_motors`, else logs a warning. Nothing with LIMBER_ALLOW_REMOTE=1. Set-up only.
void require_local(const std::string& url, bool moves_motors);

}  // namespace limber
