#include "common/run_id.h"

#include <sys/random.h>

#include "common/config_error.h"

namespace limber {

std::int64_t run_id(std::int64_t given, bool lockstep) {
  if (given != 0) return given;
  if (lockstep) return kLockstepRunId;
  std::uint64_t number = 0;
  while (number == 0) {
    if (getrandom(&number, sizeof(number), 0) != sizeof(number))
      throw ConfigError("the kernel gives no random numbers to name the run");
    number &= 0x7FFF'FFFF'FFFF'FFFFU;
  }
  return static_cast<std::int64_t>(number);
}

}  // namespace limber
