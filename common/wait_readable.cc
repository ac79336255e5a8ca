#include "common/wait_readable.h"

#include <poll.h>

#include <algorithm>
#include <array>

#include "common/clock.h"

namespace limber {

bool wait_readable(std::span<const int> descriptors, std::int64_t deadline_ns) noexcept {
  std::array<pollfd, 8> polled{};
  nfds_t count = 0;
  for (const int descriptor : descriptors) {
    if (descriptor >= 0 && count < polled.size()) polled[count++] = {descriptor, POLLIN, 0};
  }
  const std::int64_t left =
      deadline_ns <= 0 ? 0 : std::max<std::int64_t>(deadline_ns - monotonic_ns(), 0);
  const timespec timeout{left / 1'000'000'000, left % 1'000'000'000};
  return ppoll(polled.data(), count, &timeout, nullptr) > 0;
}

}  // namespace limber
