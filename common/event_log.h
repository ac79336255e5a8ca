// An LCM event log on disk, as lcm-logger writes it, or the same bytes compressed. A thread of its
// own compresses and writes, so that a slow disk does not hold up who hears the messages.
//
// A path that ends in .zst is compressed: a sequence of zstd frames, each of whole events and with
// a checksum, so that `zstd -d` gives the plain log, and a file that ends anywhere is readable to
// its last whole frame. A frame is closed after 256 KiB or a quarter of a second, whichever comes
// first, and on the disk a second later.
//
// Not allowed inside the cycle.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "common/file_descriptor.h"

namespace limber {

class EventLog {
 public:
  /// What is left free on the disk, for everything else that runs on the machine.
  static constexpr std::int64_t kLeastFree_bytes = 200'000'000;
  /// Waits for the disk at most: twenty seconds of an arm at 1 kHz.
  static constexpr std::size_t kMostWaiting_bytes = 64U << 20U;

  /// Throws ConfigError if the file exists, cannot be written, or if less than `least_free_bytes`
  /// are free.
  explicit EventLog(std::string path, std::int64_t least_free_bytes = kLeastFree_bytes);
  EventLog(const EventLog&) = delete;
  EventLog& operator=(const EventLog&) = delete;
  /// Writes what waits. Call close() to hear of failures.
  ~EventLog();

  /// Takes an event unless the disk is too slow (kMostWaiting_bytes) or refuses; false: it is left
  /// out.
  bool offer(std::int64_t time_us, std::string_view channel, const void* data, std::int32_t size);
  /// Waits for room. Throws std::runtime_error when the disk refuses (full, gone).
  void write(std::int64_t time_us, std::string_view channel, const void* data, std::int32_t size);
  /// Brings what was taken into the file without delay, and does not wait. `stored()` of the number
  /// it returns tells when it is there and outlives this process.
  std::int64_t hurry();
  bool stored(std::int64_t number) const;
  /// All events are on the disk when it returns. Throws std::runtime_error when the disk refuses.
  void close();

  /// Why nothing more is written; empty while all is well.
  std::string failure() const;
  std::int64_t bytes_on_disk() const;

 private:
  using Block = std::vector<std::uint8_t>;

  bool has_room() const { return waiting_bytes_ < kMostWaiting_bytes || !failure_.empty(); }
  void append(std::int64_t time_us, std::string_view channel, const void* data, std::int32_t size);
  void run();
  /// `taken_bytes`: of the events in it.
  void store(const Block& block, std::size_t taken_bytes);
  void check_free_space() const;
  void sync();

  const std::string path_;
  const bool compressed_;
  const std::int64_t least_free_bytes_;
  FileDescriptor file_;
  std::int64_t events_ = 0;

  mutable std::mutex mutex_;  // guards all below
  std::condition_variable filled_;
  std::condition_variable emptied_;
  std::deque<Block> blocks_;  // the last one is being filled
  std::size_t waiting_bytes_ = 0;
  std::int64_t bytes_on_disk_ = 0;
  std::string failure_;
  bool ends_ = false;
  std::int64_t taken_bytes_ = 0;
  std::int64_t stored_bytes_ = 0;
  std::int64_t hurried_bytes_ = 0;  // to be stored though their block is not full

  std::chrono::steady_clock::time_point synced_ = std::chrono::steady_clock::now();  // the thread's
  std::thread thread_;
};

}  // namespace limber
