#include "scenarios/loader/scenario.h"

namespace limber {

const TimedMessage* Timeline::peek(std::int64_t time_ns) const noexcept {
  if (messages_ == nullptr || next_ >= messages_->size()) return nullptr;
  const TimedMessage& next = (*messages_)[next_];
  return next.time_ns > time_ns ? nullptr : &next;
}

const ScenarioMessage* Timeline::due(std::int64_t time_ns) noexcept {
  const TimedMessage* next = peek(time_ns);
  if (next == nullptr) return nullptr;
  ++next_;
  return &next->message;
}

}  // namespace limber
