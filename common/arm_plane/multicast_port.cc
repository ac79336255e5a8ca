#include <sys/socket.h>

#include "common/arm_plane/datagram_port.h"
#include "common/lcm_url.h"
#include "common/multicast_socket.h"
#include "common/receive_buffer.h"
#include "common/wait_readable.h"

namespace limber {
namespace {

class MulticastPort final : public DatagramPort {
 public:
  MulticastPort(const std::string& url, const LcmAddress& address)
      : group_(address.group),
        sockets_(open_multicast("arm plane " + url, address.group, address.ttl,
                                address.receive_buffer_bytes.value_or(kReceiveBuffer_bytes))) {}

  bool send(std::span<const std::uint8_t> datagram) noexcept override {
    const auto sent = sendto(sockets_.sender.get(), datagram.data(), datagram.size(), 0,
                             reinterpret_cast<const sockaddr*>(&group_), sizeof group_);
    return sent == static_cast<ssize_t>(datagram.size());
  }
  int receive(std::span<std::uint8_t> room) noexcept override {
    return static_cast<int>(recv(sockets_.receiver.get(), room.data(), room.size(), MSG_TRUNC));
  }
  bool wait(std::int64_t deadline_ns) noexcept override {
    return wait_readable(sockets_.receiver.get(), deadline_ns);
  }

 private:
  sockaddr_in group_;
  MulticastSockets sockets_;
};

}  // namespace

std::unique_ptr<DatagramPort> open_multicast_port(const std::string& url) {
  return std::make_unique<MulticastPort>(url, parse_lcm_url(url));
}

}  // namespace limber
