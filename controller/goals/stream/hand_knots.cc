#include "controller/goals/stream/hand_knots.h"

#include "controller/goals/stream/target_stream.h"

namespace limber::controller {

void HandKnots::take(const target_stream_t& message, std::int64_t now_ns) noexcept {
  if (message.use_hand == 0) return;
  const std::int64_t start_ns = TargetStream::knot_ns(message, 0, now_ns);
  while (count_ > 0 && knot(count_ - 1).time_ns >= start_ns) --count_;
  for (int i = 0; i < message.num_knots; ++i) {
    if (count_ == kMost) {
      first_ = (first_ + 1) % kMost;
      --count_;
    }
    knot(count_++) = {TargetStream::knot_ns(message, i, now_ns), message.hand_width_m[i],
                      message.hand_force_N};
  }
}

std::optional<hand_goal_t> HandKnots::due(std::int64_t now_ns) noexcept {
  std::optional<hand_goal_t> goal;
  while (count_ > 0 && knot(0).time_ns <= now_ns) {
    goal.emplace();
    goal->width_m = static_cast<double>(knot(0).width_m);
    goal->force_N = static_cast<double>(knot(0).force_N);
    goal->speed_m_per_s = 0.0;
    first_ = (first_ + 1) % kMost;
    --count_;
  }
  return goal;
}

}  // namespace limber::controller
