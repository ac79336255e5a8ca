// A CAN bus as the rest of limber uses it, whatever carries the frames.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "drivers/can/can_filter.h"
#include "drivers/can/can_frame.h"

#pragma GCC visibility push(default)
namespace limber {

/// Where CanFrame::timestamp_ns of a received frame comes from.
enum class Stamps : std::uint8_t {
  kOnArrival,  ///< the kernel's time of arrival, CLOCK_MONOTONIC
  kOfSender,   ///< virtual buses in lock step: the simulated wire's, arm time
};

struct CanStatistics {
  std::int64_t sent = 0;
  std::int64_t received = 0;
  std::int64_t send_refused =
      0;  ///< queue full (ENOBUFS, EAGAIN) or link down: frame dropped, never queued
  std::int64_t error_frames = 0;
  std::int64_t malformed = 0;  ///< datagrams or frames that could not be a CAN frame
  std::int64_t overflow =
      0;  ///< frames lost in the receive queue, as far as the carrier counts them
  bool bus_off = false;
  bool link_down = false;
  bool unsent = false;  ///< at the last send(), frames of an earlier one waited in the queue
  int last_errno = 0;
};

/// A bus end. All members may be called inside the cycle: they never block, allocate, log or throw.
class CanBus {
 public:
  virtual ~CanBus() = default;

  /// Sends the frames in order; returns how many were accepted. What is not accepted is dropped and
  /// counted.
  virtual int send(std::span<const CanFrame> frames) noexcept = 0;
  int send(const CanFrame& frame) noexcept { return send(std::span(&frame, 1)); }

  /// Takes frames that have arrived (not our own), at most frames.size(); returns the number. Fewer
  /// than frames.size(): none is left.
  virtual int receive(std::span<CanFrame> frames) noexcept = 0;

  /// Descriptor that polls readable when receive() may return something; -1 where there is none
  /// (in-memory).
  virtual int descriptor() const noexcept = 0;

  // For carriers whose descriptor wakes only an end that has told that it will sleep. See
  // wait_readable().
  /// receive() would return something.
  virtual bool something_waits() const noexcept { return false; }
  /// From here on the descriptor polls readable when something arrives.
  virtual void about_to_sleep() noexcept {}
  /// This end has a core for itself, and had rather spin than sleep.
  virtual bool polls() const noexcept { return false; }

  virtual const CanStatistics& statistics() const noexcept = 0;

  /// From here on only error frames and what one of the filters passes need be received; a carrier
  /// that cannot leave the rest out receives it as before. Set-up only.
  virtual void set_receive_filters(std::span<const CanFilter> filters) {
    static_cast<void>(filters);
  }
};

/// Opens "socketcan:IFACE", "virtual:NAME", or an adapter on a serial line (serial_bus.h). `fd`
/// asks for CAN-FD; `bitrate_bps` is for serial adapters, an interface has its own. Throws
/// ConfigError with the reason and the cure (no such interface, interface down, no FD, no AF_CAN in
/// this kernel, no multicast route). Only a virtual bus can take the sender's stamps. Set-up only.
///
/// virtual:NAME speaks python-can's udp_multicast format. NAME "default" is python-can's own group
/// 239.74.163.2; another NAME selects a group 239.74.x.y by hash, an address "239.1.2.3" is taken
/// as it is; port 43113, TTL 0. Environment LIMBER_VIRTUAL_BUS_PORT overrides the port, and
/// LIMBER_VIRTUAL_BUS moves all virtual buses of a process into shared memory (shared_bus.h).
std::unique_ptr<CanBus> open_can_bus(const std::string& address, bool fd,
                                     Stamps stamps = Stamps::kOnArrival,
                                     int bitrate_bps = 1'000'000);

/// The address as logs name it: "virtual:NAME in shared memory" where that carries it.
std::string bus_text(const std::string& address);

/// Waits until one of the buses, or another descriptor (-1: none), is readable, or the absolute
/// CLOCK_MONOTONIC time is reached (ns; <= 0: return at once). Returns false on time-out. True does
/// not promise a frame: like poll(2) it may wake in vain, as when a frame has been read before the
/// wake for it arrives. The other descriptor does not end the spinning of a bus that polls. May be
/// called inside the cycle.
bool wait_readable(std::span<CanBus* const> buses, std::int64_t deadline_ns,
                   int other_descriptor = -1) noexcept;

}  // namespace limber
#pragma GCC visibility pop
