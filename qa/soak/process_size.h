// What this process holds of the system.
#pragma once

#include <cstdint>

namespace limber::soak {

struct ProcessSize {
  std::int64_t resident_kB = 0;
  int descriptors = 0;
};

/// From /proc/self; zero where that cannot be read.
ProcessSize process_size();

}  // namespace limber::soak
