#include "common/reader_backlog.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace limber {

ReaderBacklog::ReaderBacklog(const std::vector<std::int64_t>& processes) {
  constexpr std::string_view kSocket = "socket:[";
  for (const std::int64_t process : processes) {
    std::error_code error;
    const std::filesystem::path folder = "/proc/" + std::to_string(process) + "/fd";
    for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
      std::error_code closed;
      const std::string target = std::filesystem::read_symlink(entry->path(), closed).string();
      std::uint64_t inode = 0;
      if (target.starts_with(kSocket) &&
          std::from_chars(target.data() + kSocket.size(), target.data() + target.size(), inode)
                  .ec == std::errc())
        sockets_.insert(inode);
    }
  }
}

// One line a socket: number, local and remote address, state, tx_queue:rx_queue (hexadecimal),
// timer, retransmits, user, timeout, inode, ...
std::int64_t ReaderBacklog::bytes() const {
  std::int64_t most = 0;
  if (sockets_.empty()) return most;
  std::ifstream table("/proc/net/udp");
  std::string line;
  std::getline(table, line);
  while (std::getline(table, line)) {
    std::istringstream words(line);
    std::string skipped;
    std::string queues;
    std::uint64_t inode = 0;
    words >> skipped >> skipped >> skipped >> skipped >> queues >> skipped >> skipped >> skipped >>
        skipped >> inode;
    const auto colon = queues.find(':');
    std::int64_t waiting = 0;
    if (colon == std::string::npos || !sockets_.contains(inode)) continue;
    std::from_chars(queues.data() + colon + 1, queues.data() + queues.size(), waiting, 16);
    most = std::max(most, waiting);
  }
  return most;
}

}  // namespace limber
