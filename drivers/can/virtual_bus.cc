#include "drivers/can/virtual_bus.h"

#include <arpa/inet.h>
#include <linux/filter.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>

#include "common/config_error.h"
#include "drivers/can/datagram_bus.h"
#include "drivers/can/virtual_frame.h"

namespace limber {
namespace {

constexpr const char* kDefaultGroup = "239.74.163.2";
constexpr std::uint16_t kDefaultPort = 43113;
constexpr std::size_t kLongestDatagramBytes = 1024;  // ours have at most 256; others may add keys

[[noreturn]] void refuse_bus(const std::string& name, const std::string& problem) {
  throw ConfigError("virtual:" + name + ": " + problem);
}

[[noreturn]] void refuse_with_errno(const std::string& name, const std::string& attempt) {
  if (errno == ENETUNREACH || errno == ENODEV || errno == EADDRNOTAVAIL) {
    refuse_bus(name,
               "there is no multicast route on this machine. Without a network it needs:\n"
               "  sudo ip link set lo multicast on\n  sudo ip route add 224.0.0.0/4 dev lo");
  }
  refuse_bus(name, attempt + ": " + std::strerror(errno));
}

std::uint32_t fnv1a(const std::string& text) {
  std::uint32_t hash = 2166136261U;
  for (const char c : text) hash = (hash ^ static_cast<std::uint8_t>(c)) * 16777619U;
  return hash;
}

FileDescriptor open_udp(const std::string& name) {
  FileDescriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (socket.get() < 0) refuse_with_errno(name, "cannot open a socket");
  return socket;
}

template <typename Value>
void set(const std::string& name, int socket, int level, int option, const Value& value) {
  if (setsockopt(socket, level, option, &value, sizeof(value)) != 0) {
    refuse_with_errno(name, "cannot set up the socket");
  }
}

const sockaddr* generic(const sockaddr_in* address) {
  return reinterpret_cast<const sockaddr*>(address);
}

FileDescriptor open_receiver(const std::string& name, const sockaddr_in& group) {
  FileDescriptor socket = open_udp(name);
  set(name, socket.get(), SOL_SOCKET, SO_REUSEADDR, 1);
  set(name, socket.get(), SOL_SOCKET, SO_REUSEPORT, 1);
  set(name, socket.get(), IPPROTO_IP, IP_MULTICAST_ALL, 0);
  prepare_receive(socket.get());
  // Bound to the group, not to any address: other buses on the same port stay out.
  if (bind(socket.get(), generic(&group), sizeof(group)) != 0) {
    refuse_with_errno(name, "cannot bind to port " + std::to_string(ntohs(group.sin_port)));
  }
  // No interface named: the kernel joins where its route to the group leads, and sent frames take
  // the same route.
  set(name, socket.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, ip_mreqn{group.sin_addr, {}, 0});
  return socket;
}

/// Sends from a port of its own, by which our frames are distinguished from all others. Not
/// connected: the kernel would fix a source address, and then prefer that address's interface to
/// the route.
FileDescriptor open_sender(const std::string& name) {
  FileDescriptor socket = open_udp(name);
  set(name, socket.get(), IPPROTO_IP, IP_MULTICAST_TTL, 0);
  set(name, socket.get(), IPPROTO_IP, IP_MULTICAST_LOOP, 1);
  sockaddr_in any{};
  any.sin_family = AF_INET;
  if (bind(socket.get(), generic(&any), sizeof(any)) != 0)
    refuse_with_errno(name, "cannot bind a port to send from");
  return socket;
}

/// Multicast brings a sender's datagrams back to its own host, where a port has one owner. The
/// kernel drops ours here, before they wake anybody up.
void drop_own(const std::string& name, int receiver, int sender) {
  sockaddr_in own{};
  socklen_t size = sizeof(own);
  if (getsockname(sender, reinterpret_cast<sockaddr*>(&own), &size) != 0) {
    refuse_with_errno(name, "cannot read the port to send from");
  }
  constexpr std::uint32_t kSourcePort = 0;  // a UDP socket's filter sees the UDP header first
  std::array<sock_filter, 4> program = {{
      BPF_STMT(BPF_LD | BPF_H | BPF_ABS, kSourcePort),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, ntohs(own.sin_port), 0, 1),
      BPF_STMT(BPF_RET | BPF_K, 0),
      BPF_STMT(BPF_RET | BPF_K, 0xFFFFFFFFU),
  }};
  set(name, receiver, SOL_SOCKET, SO_ATTACH_FILTER, sock_fprog{program.size(), program.data()});
}

class VirtualBus final : public DatagramBus {
 public:
  VirtualBus(const std::string& name, bool fd, Stamps stamps)
      : DatagramBus(fd, stamps, kLongestEncodedBytes, kLongestDatagramBytes) {
    sockaddr_in group{};
    group.sin_family = AF_INET;
    group.sin_port = htons(virtual_bus_port());
    inet_pton(AF_INET, virtual_bus_group(name).c_str(), &group.sin_addr);
    receiver_ = open_receiver(name, group);
    sender_ = open_sender(name);
    drop_own(name, receiver_.get(), sender_.get());
    outgoing_.set_destination(group);
  }

 private:
  std::size_t encode(const CanFrame& frame, std::span<std::uint8_t> out) const noexcept override {
    return encode_datagram(frame, out);
  }
  bool decode(std::span<const std::uint8_t> datagram, CanFrame* frame) const noexcept override {
    return decode_datagram(datagram, frame);
  }
  bool note_received(const CanFrame& frame) noexcept override { return fd_ || !frame.fd; }

  void note_sent(int sent, int wanted) noexcept override {
    statistics_.link_down =
        sent == 0 && (errno == ENETUNREACH || errno == ENETDOWN || errno == ENODEV);
    if (sent < wanted) statistics_.last_errno = errno;
  }
  bool note_receive_error() noexcept override {
    statistics_.last_errno = errno;
    return false;
  }
};

}  // namespace

std::string virtual_bus_group(const std::string& name) {
  if (name == "default") return kDefaultGroup;
  in_addr address{};
  if (inet_pton(AF_INET, name.c_str(), &address) == 1) {
    if (IN_MULTICAST(ntohl(address.s_addr))) return name;
    refuse_bus(name, "is no multicast address: 224.0.0.0 to 239.255.255.255");
  }
  const auto is_allowed = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '_';
  };
  if (name.empty() || !std::all_of(name.begin(), name.end(), is_allowed)) {
    refuse_bus(name, "a name has letters, digits, '-' and '_' only, or is a multicast address");
  }
  const std::uint32_t hash = fnv1a(name);
  const std::uint32_t low = (hash ^ (hash >> 16U)) & 0xFFFFU;
  return "239.74." + std::to_string(low >> 8U) + "." + std::to_string(low & 0xFFU);
}

std::uint16_t virtual_bus_port() {
  const char* text = std::getenv("LIMBER_VIRTUAL_BUS_PORT");
  if (text == nullptr) return kDefaultPort;
  std::uint16_t value = 0;
  const char* end = text + std::strlen(text);
  const auto [stop, error] = std::from_chars(text, end, value);
  if (error != std::errc() || stop != end || value == 0) {
    throw ConfigError("LIMBER_VIRTUAL_BUS_PORT: '" + std::string(text) +
                      "' is not a port: 1 to 65535");
  }
  return value;
}

std::unique_ptr<CanBus> open_virtual_bus(const std::string& name, bool fd, Stamps stamps) {
  return std::make_unique<VirtualBus>(name, fd, stamps);
}

}  // namespace limber
