// A virtual bus in memory that its ends share, for processes that wait for one another's frames.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "common/shared_memory/shared_ring.h"
#include "drivers/can/can_bus.h"

namespace limber {

/// What $LIMBER_VIRTUAL_BUS chooses for all virtual buses of a process: "udp" (the default)
/// nothing, "shm" and "shm?poll" shared memory. Throws ConfigError. Set-up only.
struct SharedBusOptions {
  bool poll = false;  ///< a process that waits spins
};
std::optional<SharedBusOptions> shared_bus_options();

/// Ends that a bus can have at one time: driver, simulator, and tools beside them.
inline constexpr std::size_t kSharedBusEnds = 8;

/// A frame in a ring: when it was sent and its sender's stamp, ns, then its kernel form.
using FrameRing = SharedRing<256, 11>;

/// All of it 0: nothing was sent. Each end writes its ring, and reads all others.
struct SharedBusMemory {
  struct End {
    FrameRing ring;
    /// The end sleeps on its FIFO; whoever sets this to 0 again writes a byte there.
    std::atomic<std::uint32_t> asleep;
  };
  std::array<End, kSharedBusEnds> ends;
};

/// /dev/shm/limber-bus-GROUP-PORT of the virtual bus `name` (virtual_bus.h). Throws ConfigError.
/// Set-up only.
std::string shared_bus_path(const std::string& name);

/// Joins the bus `name`, which behaves like that over UDP, but is heard by limber's own programs
/// alone, those of this user. FD frames are ignored unless `fd`. An end that is 256 frames of
/// another one behind loses the oldest (`overflow`). Throws ConfigError: the memory cannot be had
/// (see SharedObject), or all ends are taken. Set-up only.
std::unique_ptr<CanBus> open_shared_bus(const std::string& name, bool fd, Stamps stamps,
                                        const SharedBusOptions& options);

}  // namespace limber
