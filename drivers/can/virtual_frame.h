// The datagrams of python-can's udp_multicast bus: one frame as one MessagePack map. Bytes only, no
// I/O, no allocation.
//
//   timestamp: float   arbitration_id: int   dlc: int   data: bin   channel: nil
//   is_extended_id, is_remote_frame, is_error_frame, is_fd, bitrate_switch,
//   error_state_indicator: bool
//
// A remote frame has its length in dlc and no data.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/can/can_frame.h"

namespace limber {

/// Longest datagram that encode_datagram() makes.
inline constexpr std::size_t kLongestEncodedBytes = 256;

/// Writes a possible frame, byte for byte as python-can does; returns the number of bytes. `out`
/// has at least kLongestEncodedBytes. Allowed in the cycle.
std::size_t encode_datagram(const CanFrame& frame, std::span<std::uint8_t> out) noexcept;

/// Reads any MessagePack form of the map above, keys in any order. Unknown keys are skipped,
/// missing ones have python-can's defaults (is_extended_id: true), but arbitration_id must be
/// there. False if the datagram is malformed or describes a frame that no bus could carry; `frame`
/// is then unspecified. Timestamp: left 0, because the sender's clock is not ours. Allowed in the
/// cycle.
[[nodiscard]] bool decode_datagram(std::span<const std::uint8_t> datagram,
                                   CanFrame* frame) noexcept;

}  // namespace limber
