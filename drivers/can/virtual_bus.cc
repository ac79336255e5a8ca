#include "drivers/can/virtual_bus.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>

#include "common/config_error.h"
#include "common/multicast_socket.h"
#include "common/receive_buffer.h"
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

std::uint32_t fnv1a(const std::string& text) {
  std::uint32_t hash = 2166136261U;
  for (const char c : text) hash = (hash ^ static_cast<std::uint8_t>(c)) * 16777619U;
  return hash;
}

class VirtualBus final : public DatagramBus {
 public:
  VirtualBus(const std::string& name, bool fd, Stamps stamps)
      : DatagramBus(fd, stamps, kLongestEncodedBytes, kLongestDatagramBytes) {
    sockaddr_in group{};
    group.sin_family = AF_INET;
    group.sin_port = htons(virtual_bus_port());
    inet_pton(AF_INET, virtual_bus_group(name).c_str(), &group.sin_addr);
    MulticastSockets sockets = open_multicast("virtual:" + name, group, 0, kReceiveBuffer_bytes);
    prepare_receive(sockets.receiver.get());
    receiver_ = std::move(sockets.receiver);
    sender_ = std::move(sockets.sender);
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
