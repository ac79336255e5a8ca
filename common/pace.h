// What decides when a cycle begins.
#pragma once

#include <cstdint>

namespace limber {

enum class Pace : std::uint8_t {
  kRealtime,  ///< the clock, in each process for itself: real buses, or to see this machine
  kLockstep,  ///< the others' answers: as fast as the processor allows
  kPaced,     ///< the same, but no sooner than the clock allows; simulated time waits for the host
};

/// Driver, controller and simulator wait for one another, however long it takes.
constexpr bool in_lockstep(Pace pace) noexcept { return pace != Pace::kRealtime; }

}  // namespace limber
