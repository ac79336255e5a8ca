// Lock step on the wire. On a simulated arm without a clock the driver
// ends each cycle with a TICK frame, and the simulator, having advanced by exactly one period,
// answers TOCK with the same number. All replies to the cycle's commands lie before the TOCK, so a
// lost reply is known to be lost without waiting. A TICK that is repeated (same number) is answered
// again without advancing. Both are 29-bit frames, so no 11-bit motor node ever sees them; on a
// real arm they do not exist.
#pragma once

#include <cstdint>

#include "drivers/can/can_frame.h"

namespace limber::lockstep {

inline constexpr std::uint32_t kTickId = 0x1FFFFFF0;
inline constexpr std::uint32_t kTockId = 0x1FFFFFF1;

/// TICK of this number lets no time pass: what waits on a simulated wire is delivered, for the roll
/// call before the first cycle. It has no TOCK.
inline constexpr std::int64_t kStandstill = -1;

/// Frame with an 8-byte little-endian sequence number.
CanFrame tick(std::int64_t seq) noexcept;
CanFrame tock(std::int64_t seq) noexcept;

bool is_tick(const CanFrame& frame) noexcept;
bool is_tock(const CanFrame& frame) noexcept;
std::int64_t sequence(const CanFrame& frame) noexcept;

}  // namespace limber::lockstep
