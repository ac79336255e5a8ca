// limber's own force/torque protocol on CAN-FD, for sensors that quantise nothing: no product
// speaks it. Bytes only, both directions.
//
//   request    2 bytes  0x0A, counter
//   reply     32 bytes  0x0A, counter of the request, overload bits, 0, Fx Fy Fz Tx Ty Tz as
//                       float32 (N, N m; little-endian), four bytes 0
#pragma once

#include <cstdint>

#include "drivers/can/can_frame.h"
#include "drivers/protocols/wrench_reading.h"

#pragma GCC visibility push(default)
namespace limber::limber_ft {

inline constexpr int kRequestBytes = 2;
inline constexpr int kReplyBytes = 32;

// Allowed inside the cycle throughout.

CanFrame encode_request(std::uint32_t id, std::uint8_t counter) noexcept;
[[nodiscard]] bool decode_request(const CanFrame& frame, std::uint32_t id,
                                  std::uint8_t* counter) noexcept;

/// Values beyond float32 saturate. False, and nothing written, if one is not finite.
[[nodiscard]] bool encode_reply(const WrenchReading& reading, std::uint8_t counter,
                                std::uint32_t id, CanFrame* frame) noexcept;
/// The caller has matched the identifier. False, and nothing written, unless it is an FD frame of
/// 32 bytes that answers a request, with six finite numbers.
[[nodiscard]] bool decode_reply(const CanFrame& frame, std::uint8_t* counter,
                                WrenchReading* reading) noexcept;

}  // namespace limber::limber_ft
#pragma GCC visibility pop
