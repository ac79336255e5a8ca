#include "tools/record/episode_marks.h"

#include <spdlog/spdlog.h>

#include <utility>

#include "common/decode_message.h"
#include "lcmtypes/channels.h"

namespace limber {

bool EpisodeMarks::take(const LcmDatagram& message) {
  if (message.channel != channels::kEpisode) return false;
  const bool fits = decode_message(message.message.data(), message.message.size(), &mark_) &&
                    mark_.mark >= episode_mark_t::MARK_START &&
                    mark_.mark <= episode_mark_t::MARK_KEEP &&
                    mark_.task.size() <= std::size_t{episode_mark_t::LONGEST_TASK};
  if (!fits && !std::exchange(told_, true))
    spdlog::warn("a message on {} that is no mark of an episode: not confirmed", message.channel);
  return fits;
}

void EpisodeMarks::send(const episode_mark_t& mark) {
  if (!port_.publish(channels::kEpisodeKept, mark))
    spdlog::warn("{} could not be sent: who has set the mark sends it again",
                 channels::kEpisodeKept);
}

}  // namespace limber
