#include "scenarios/scenario.h"

namespace limber {

const ScenarioMessage* Timeline::due(std::int64_t time_ns) noexcept {
  if (messages_ == nullptr || next_ >= messages_->size()) return nullptr;
  const TimedMessage& next = (*messages_)[next_];
  if (next.time_ns > time_ns) return nullptr;
  ++next_;
  return &next.message;
}

}  // namespace limber
