// Where driver and controller meet in shared memory: /dev/shm/limber-arm-NAME.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>

#include "common/shared_memory/shared_object.h"
#include "common/shared_memory/shared_ring.h"

namespace limber {

/// shm:NAME, with ?poll, ?group=GROUP or ?poll&group=GROUP.
struct SharedMemoryAddress {
  SharedPlace place;
  bool poll = false;  ///< this end spins while it waits
};

/// Throws ConfigError. Set-up only.
SharedMemoryAddress parse_shared_memory_address(const std::string& url);

/// As many states as a controller may miss while this machine pauses it for 50 ms.
using ArmRing = SharedRing<64, 184>;

/// All of it 0: nothing was sent. Each end writes the ring and the holder of its number, and
/// whether it sleeps and wants to be woken.
struct SharedMemory {
  std::array<ArmRing, 2> rings;
  std::array<std::atomic<std::uint32_t>, 2> sleeping;
  std::array<std::atomic<std::uint32_t>, 2> holders;  ///< processes; for messages to people alone
};

}  // namespace limber
