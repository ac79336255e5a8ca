// Everything that is sent on an LCM plane, from the kernel's queue in one thread, with the time at
// which it arrived there. Unlike LcmPort it hears all channels, and long messages, too.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "common/datagram_batch.h"
#include "common/file_descriptor.h"
#include "common/lcm_fragments.h"
#include "common/wall_clock.h"

namespace limber {

class LcmListener {
 public:
  /// See parse_lcm_url(). Its receive buffer of 64 MB, or the one that `url` asks for, holds what
  /// comes while this process is held up; a note tells if the system permits far less. Throws
  /// ConfigError.
  explicit LcmListener(const std::string& url);

  /// `time_us`: by the wall clock as it was set when this began, so that no time goes back or
  /// leaps when it is set meanwhile; of a message in fragments, that of the last.
  using Handler = std::function<void(std::int64_t time_us, const LcmDatagram& message)>;
  /// Handles one batch of what has arrived, without waiting; returns how many datagrams it was.
  /// What is no message is left out, and told once. Throws what `handler` throws, and
  /// std::runtime_error if the socket fails.
  int take_batch(const Handler& handler);

  /// Readable when something has arrived.
  int descriptor() const { return socket_.get(); }
  /// When the newest datagram that was taken arrived; CLOCK_MONOTONIC.
  std::int64_t newest_ns() const { return newest_ns_; }
  /// Datagrams that the kernel has dropped because its buffer was full.
  std::int64_t dropped() const;
  /// Messages of which a fragment never came.
  std::int64_t incomplete() const {
    return fragments_.given_up() + static_cast<std::int64_t>(fragments_.waiting());
  }

 private:
  void take(int i, const Handler& handler);

  FileDescriptor socket_;
  ReceiveBatch batch_;
  LcmFragments fragments_;
  std::int64_t epoch_minus_monotonic_ns_ = epoch_minus_monotonic_ns();
  std::int64_t newest_ns_ = 0;
  bool told_ = false;
};

}  // namespace limber
