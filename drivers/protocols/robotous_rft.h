// Force/torque sensors of the Robotous RFT series on classic CAN: bytes only, both directions.
//
//   request   8 bytes   D1 = 0x0A ("F/T 1 sample output"), D2..D8 = 0
//   reply    16 bytes in two frames of 8 on two identifiers:
//            D1 = 0x0A, D2..D13 = Fx Fy Fz Tx Ty Tz as int16, upper byte first (Tx lies astride the
//            frames), D14 = overload bits, D15 D16 = 0
//   value    force = count / 50 N, torque = count / 2000 N m as delivered (model dependent)
//
// Identifiers as delivered: request 100, replies 1 and 2; 1 Mbit/s. Sources: Robotous, RFT Series
// Installation and Operation Manual, rev. 1.8, sections 3.2 to 3.4 (commands, packets,
// identifiers); the vendor's sample code for the CAN interface, rev. 1.2 (byte order, divisors,
// overload bits). The series also streams by itself (0x0B); limber sends, so that a measurement
// belongs to its cycle.
#pragma once

#include <array>
#include <cstdint>

#include "drivers/can/can_frame.h"
#include "drivers/protocols/wrench_reading.h"

#pragma GCC visibility push(default)
namespace limber::robotous_rft {

inline constexpr int kBytes = 8;  ///< of every frame

/// Counts per N and per N m, as set in the sensor.
struct Scale {
  double counts_per_N = 50.0;
  double counts_per_Nm = 2000.0;
};

// Allowed inside the cycle throughout.

CanFrame encode_request(std::uint32_t id) noexcept;
[[nodiscard]] bool decode_request(const CanFrame& frame, std::uint32_t id) noexcept;

/// Values round to the nearest count and saturate. False, and nothing written, if one is not
/// finite.
[[nodiscard]] bool encode_reply(const WrenchReading& reading, const Scale& scale,
                                const std::array<std::uint32_t, 2>& ids,
                                std::array<CanFrame, 2>* frames) noexcept;
/// Both halves in order; the caller has matched their identifiers. False unless both have 8 bytes
/// and the first one answers "1 sample output".
[[nodiscard]] bool decode_reply(const CanFrame& first, const CanFrame& second, const Scale& scale,
                                WrenchReading* reading) noexcept;

}  // namespace limber::robotous_rft
#pragma GCC visibility pop
