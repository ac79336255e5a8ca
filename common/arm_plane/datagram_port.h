// One end of the arm plane: datagrams to and from the process at the other end.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace limber {

enum class ArmPlaneEnd { kDriver, kController };

/// After construction allowed in the cycle; nothing but wait() blocks.
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
  /// Until a datagram waits (true) or the absolute CLOCK_MONOTONIC time has come (ns; <= 0: returns
  /// at once). A signal ends the wait, too.
  virtual bool wait(std::int64_t deadline_ns) noexcept = 0;
  /// Datagrams that were dropped: their sender may not send here, or they were overwritten.
  virtual std::int64_t dropped() const noexcept { return 0; }
};

/// udpm://GROUP:PORT: whoever is in the group hears everything; see parse_lcm_url(). Throws
/// ConfigError.
std::unique_ptr<DatagramPort> open_multicast_port(const std::string& url);

/// unix:PATH: the sockets PATH.driver and PATH.controller. Taken are datagrams of this user, of
/// root, and of members of the group that owns the folder; the kernel names the sender. Throws
/// ConfigError for a folder in which anybody may write, and if another process has this end.
std::unique_ptr<DatagramPort> open_unix_port(const std::string& url, ArmPlaneEnd end);

/// shm:NAME: a ring of messages each way in memory that both map; see shared_object.h for who may,
/// and for its options. A process that sleeps is woken by futex; one that polls needs a core of its
/// own. Throws ConfigError.
std::unique_ptr<DatagramPort> open_shared_memory_port(const std::string& url, ArmPlaneEnd end);

}  // namespace limber
