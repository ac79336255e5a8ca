// Whether a client's process still runs.
#pragma once

#include <cstdint>

namespace limber {

/// A client whose number has this bit holds the lock `client NUMBER` (common/run_lock.h) for as
/// long as its process lives.
inline constexpr std::int64_t kClientWithLock = std::int64_t{1} << 62;

/// Such a client has ended. Of others nobody knows: false. Two system calls; between cycles.
bool client_gone(std::int64_t client) noexcept;

}  // namespace limber
