// Addresses of LCM planes: what is allowed, and whether others on the network can send to them.
#pragma once

#include <netinet/in.h>

#include <optional>
#include <string>

namespace limber {

struct LcmAddress {
  sockaddr_in group{};
  int ttl = 0;
  std::optional<int> receive_buffer_bytes;  ///< as asked for
};

/// Allowed is udpm://[GROUP[:PORT]] with at most one `ttl`, which is 0 unless LIMBER_ALLOW_REMOTE=1
/// is set (messages stay on this machine), and `recv_buf_size`. Throws ConfigError. Set-up only.
LcmAddress parse_lcm_url(const std::string& url);

/// $LIMBER_ARM_URL or the arm plane's address of the channel table; $LCM_DEFAULT_URL or the user
/// plane's.
std::string arm_plane_url();
std::string user_plane_url();

/// A ttl of 0 bounds what goes out, not what comes in: a multicast group is joined on the interface
/// to which this machine routes it. If that is a network's, others can send to `url`: throws
/// ConfigError with the command that prevents it if `moves_motors`, else notes it in the log.
/// Nothing with LIMBER_ALLOW_REMOTE=1, for a Unix socket or shared memory. Set-up only.
void require_local(const std::string& url, bool moves_motors);

}  // namespace limber
