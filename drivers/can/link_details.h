// What the kernel knows of a CAN interface beyond its name: kind, bit timing, state, queue. Read by
// rtnetlink, which needs no privilege.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace limber {

/// In the kernel's order.
enum class CanControllerState : std::uint8_t {
  kErrorActive,
  kErrorWarning,
  kErrorPassive,
  kBusOff,
  kStopped,
  kSleeping,
};

/// Bit rates in bit/s, 0: not told. Interfaces without a bit time (vcan, vxcan) tell none of what
/// belongs to a controller.
struct LinkDetails {
  std::string kind;  ///< "can": a controller; "vcan", "vxcan"; empty: not told
  std::uint32_t queue_frames = 0;
  std::uint32_t bitrate = 0;
  std::uint32_t data_bitrate = 0;
  bool fd = false;               ///< CAN-FD switched on
  std::uint32_t restart_ms = 0;  ///< after bus-off; 0: never by itself
  CanControllerState state = CanControllerState::kErrorActive;

  bool has_bit_timing() const { return kind == "can" && bitrate != 0; }
};

/// The kernel's answer (RTM_NEWLINK) in the bytes of linux/rtnetlink.h and linux/can/netlink.h;
/// nothing if it is none, or damaged. Set-up only.
std::optional<LinkDetails> parse_link_details(std::span<const std::byte> message);

/// Nothing without such an interface, or where the kernel does not answer. Set-up only.
std::optional<LinkDetails> read_link_details(const std::string& interface);

}  // namespace limber
