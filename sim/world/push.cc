#include "sim/world/push.h"

#include <cmath>
#include <numbers>

namespace limber::sim {
namespace {

/// 0 to 1 with zero slope at both ends, over 0 < t < length; a step for length 0.
double smooth_edge(std::int64_t t, std::int64_t length) {
  if (t >= length) return 1.0;
  return 0.5 -
         0.5 * std::cos(std::numbers::pi * static_cast<double>(t) / static_cast<double>(length));
}

}  // namespace

Vector6 Push::at(std::int64_t t_ns) const noexcept {
  const std::int64_t age = t_ns - start_ns;
  if (age < 0 || age >= duration_ns) return Vector6::Zero();
  const double rise = smooth_edge(age, ramp_ns);
  const double fall = smooth_edge(duration_ns - age, ramp_ns);
  return fall * (from + rise * (wrench - from));
}

bool PushSlots::add(Push push, std::int64_t now_ns) noexcept {
  drop_finished(now_ns);
  push.start_ns = now_ns;
  push.from.setZero();
  for (int i = 0; i < count_; ++i) {
    if (slots_[i].id != push.id) continue;
    if (slots_[i].link == push.link) push.from = slots_[i].at(now_ns);
    slots_[i] = push;
    return true;
  }
  if (count_ == kSlots) return false;
  slots_[count_++] = push;
  return true;
}

void PushSlots::drop_finished(std::int64_t now_ns) noexcept {
  int kept = 0;
  for (int i = 0; i < count_; ++i) {
    if (!slots_[i].over(now_ns)) slots_[kept++] = slots_[i];
  }
  count_ = kept;
}

}  // namespace limber::sim
