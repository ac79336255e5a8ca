#include "drivers/configure.h"

namespace limber {

void ConfigureDialogue::start() noexcept {
  failed_ = false;
  advanced_ = false;
  go_to(family_->starts_with_disable() ? 0 : 1);
}

CanFrame ConfigureDialogue::next_frame() noexcept {
  if (done() || waited_ > 0) return family_->state_request();
  return step_ == 0 ? family_->disable() : family_->ask(question());
}

bool ConfigureDialogue::receive(const CanFrame& frame) noexcept {
  // One answer a cycle: a step that was reached in this cycle has not been asked for yet.
  if (expects_state() || failed_ || advanced_) return false;
  double found = 0.0;
  const Answer answer = family_->judge(question(), frame, &found);
  if (answer == Answer::kNone) return false;
  failure_.answer = answer;
  failure_.found = found;
  if (answer == Answer::kRight) advance();
  if (answer == Answer::kWrong || answer == Answer::kRefused) failed_ = true;
  return true;
}

void ConfigureDialogue::receive_state(bool enabled) noexcept {
  if (step_ == 0 && !enabled) advance();
}

void ConfigureDialogue::close_cycle() noexcept {
  const bool over = advanced_ || done() || failed_;
  advanced_ = false;
  if (over) return;
  if (step_ > 0 && !family_->question(question()).answered) {
    go_to(step_ + 1);
  } else if (++waited_ >= family_->patience_cycles()) {
    waited_ = 0;
    if (++attempts_ >= kAttempts) failed_ = true;
  }
}

void ConfigureDialogue::advance() noexcept {
  go_to(step_ + 1);
  advanced_ = true;
}

void ConfigureDialogue::go_to(int step) noexcept {
  step_ = step;
  attempts_ = 0;
  waited_ = 0;
  failure_ = {};
  if (step_ == 0 || done()) return;
  const StartupQuestion asked = family_->question(question());
  failure_.reg = asked.reg;
  failure_.expected = asked.expected;
}

}  // namespace limber
