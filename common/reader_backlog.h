// How far other processes are behind with what was sent to their UDP sockets, as the kernel counts
// it. Senders of multicast datagrams are not held up by a slow receiver: what its buffer cannot
// take is lost. A sender that may wait, because no clock drives it, asks here. Set-up, and between
// cycles: reads files.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

namespace limber {

class ReaderBacklog {
 public:
  /// The sockets that these processes have open now. A process that is gone, or of another user,
  /// has none.
  explicit ReaderBacklog(const std::vector<std::int64_t>& processes);

  bool watches_any() const noexcept { return !sockets_.empty(); }
  /// Bytes in the fullest of the sockets' buffers, counted as the kernel does: with its own data.
  std::int64_t bytes() const;

 private:
  std::set<std::uint64_t> sockets_;  ///< inodes
};

}  // namespace limber
