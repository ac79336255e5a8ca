// What is sent on an LCM plane, received in a thread of its own for a program that may be busy.
// Nothing of a datagram is believed: a channel's name must end, a fragment lie within its message.
#pragma once

#include <netinet/in.h>

#include <array>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "common/file_descriptor.h"
#include "common/lcm_fragments.h"

namespace limber {

class PlaneReceiver {
 public:
  /// More than this waits for a program that takes nothing; bytes. The rest is dropped.
  static constexpr std::size_t kMostWaiting = 256U << 20U;

  /// Joins `group` where this machine routes it. Throws ConfigError.
  explicit PlaneReceiver(const sockaddr_in& group);
  ~PlaneReceiver();
  PlaneReceiver(const PlaneReceiver&) = delete;
  PlaneReceiver& operator=(const PlaneReceiver&) = delete;

  /// Messages on `channel` are kept from here on, under this number; -1: no more. May allocate.
  void hear(const std::string& channel, std::int32_t number);

  /// Until something waits to be taken (true), or so long has passed.
  bool wait(std::int64_t timeout_ns);
  /// All that has been kept since the last call, which is valid until the next: of each message the
  /// number of its channel, its size (4 bytes each, in this machine's order), its bytes.
  std::span<const std::uint8_t> take();

  /// Datagrams that are no messages of LCM's, or for which there was no room.
  std::int64_t malformed() const;
  std::int64_t dropped() const;

 private:
  void run() noexcept;
  void take_arrived() noexcept;
  void handle(std::span<const std::uint8_t> datagram, const sockaddr_in& sender);
  void keep(const LcmDatagram& message);

  FileDescriptor socket_;
  FileDescriptor stop_;  ///< an eventfd
  LcmFragments fragments_;
  std::vector<std::uint8_t> room_;

  mutable std::mutex mutex_;  ///< guards what follows
  std::condition_variable news_;
  std::map<std::string, std::int32_t, std::less<>> channels_;
  std::vector<std::uint8_t> waiting_;
  std::vector<std::uint8_t> taken_;
  std::int64_t malformed_ = 0;
  std::int64_t dropped_ = 0;

  std::thread thread_;
};

}  // namespace limber
