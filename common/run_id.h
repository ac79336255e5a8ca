// Numbers that tell one run of a process from another: sessions of the driver, controllers.
#pragma once

#include <cstdint>

namespace limber {

/// Session and controller of every lock-step run, so that its payloads do not depend on chance.
inline constexpr std::int64_t kLockstepRunId = 1;

/// `given` if it is not 0; otherwise kLockstepRunId in lock step and a random positive number in
/// realtime. Throws ConfigError if the kernel gives none. Set-up only.
std::int64_t run_id(std::int64_t given, bool lockstep);

}  // namespace limber
