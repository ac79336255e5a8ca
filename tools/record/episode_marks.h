// Marks of episodes that are in the log's file are sent again, so that who has set one can tell
// that it is kept, and sends it once more if it is not.
#pragma once

#include <cstdint>
#include <deque>
#include <limber/episode_mark_t.hpp>
#include <string>
#include <utility>

#include "common/arm_plane/lcm_datagram.h"
#include "common/lcm_port.h"

namespace limber {

class EpisodeMarks {
 public:
  /// Throws ConfigError.
  explicit EpisodeMarks(const std::string& url) : port_(url, LcmPort::Use::kPublishOnly) {}

  /// True if this is a mark on EPISODE, in form and content. What is none stays in the log as it
  /// is, unconfirmed; the first is warned of.
  bool take(const LcmDatagram& message);
  /// The mark taken last is in the file when that is true of `number` (EventLog::hurry).
  void wait_for(std::int64_t number) { waiting_.emplace_back(number, mark_); }
  /// Sends those on EPISODE_KEPT of whose number `stored` is true.
  template <typename Stored>
  void confirm(const Stored& stored) {
    for (; !waiting_.empty() && stored(waiting_.front().first); waiting_.pop_front())
      send(waiting_.front().second);
  }

 private:
  void send(const episode_mark_t& mark);

  LcmPort port_;
  episode_mark_t mark_{};
  std::deque<std::pair<std::int64_t, episode_mark_t>> waiting_;
  bool told_ = false;
};

}  // namespace limber
