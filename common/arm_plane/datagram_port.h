// One end of the arm plane: datagrams to and from the process at the other end.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace limber {

enum class ArmPlaneEnd { kDriver, kController };

/// After construction allowed in the cycle; nothing blocks.
class DatagramPort {
 public:
  DatagramPort() = default;
  DatagramPort(const DatagramPort&) = delete;
  DatagramPort& operator=(const DatagramPort&) = delete;
  virtual ~DatagramPort() = default;

  /// False if it could not be sent.
  virtual bool send(std::span<const std::uint8_t> datagram) noexcept = 0;
  /// The size of the next datagram, whose bytes are in `room` as far as they fit; -1 if none waits.
  virtual int receive(std::span<std::uint8_t> room) noexcept = 0;
  /// Readable when a datagram waits.
  virtual int descriptor() const noexcept = 0;
  /// Datagrams that were dropped since their sender may not send here.
  virtual std::int64_t refused() const noexcept { return 0; }
};

/// udpm://GROUP:PORT: whoever is in the group hears everything; see parse_lcm_url(). Throws
/// ConfigError.
std::unique_ptr<DatagramPort> open_multicast_port(const std::string& url);

/// unix:PATH: the sockets PATH.driver and PATH.controller. Taken are datagrams of this user, of
/// root, and of members of the group that owns the folder; the kernel names the sender. Throws
/// ConfigError for a folder in which anybody may write, and if another process has this end.
std::unique_ptr<DatagramPort> open_unix_port(const std::string& url, ArmPlaneEnd end);

}  // namespace limber
