#include "controller/client_life.h"

#include <array>
#include <cstdio>

#include "common/run_lock.h"

namespace limber {

bool client_gone(std::int64_t client) noexcept {
  if ((client & kClientWithLock) == 0 || client < 0) return false;
  std::array<char, 32> name{};
  std::snprintf(name.data(), name.size(), "client %lld", static_cast<long long>(client));
  return run_lock_free(name.data());
}

}  // namespace limber
