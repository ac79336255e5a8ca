#include "qa/soak/process_size.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace limber::soak {

ProcessSize process_size() {
  ProcessSize size;
  std::int64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages >> pages;  // the second number
  size.resident_kB = pages * ::sysconf(_SC_PAGESIZE) / 1024;
  std::error_code unreadable;
  for (auto entry = std::filesystem::directory_iterator("/proc/self/fd", unreadable);
       entry != std::filesystem::directory_iterator(); entry.increment(unreadable)) {
    if (unreadable) break;
    ++size.descriptors;
  }
  return size;
}

}  // namespace limber::soak
