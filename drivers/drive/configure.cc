#include "drivers/drive/configure.h"

namespace limber {

void ConfigureDialogue::start() noexcept {
  failed_ = false;
  advanced_ = false;
  missing_count_ = 0;
  go_to(0);
}

CanFrame ConfigureDialogue::next_frame() noexcept {
  advanced_ = false;  // by an answer that came between the cycles
  if (done() || (waited_ > 0 && !repeat_)) return codec_->state_request();
  repeat_ = false;
  return step_ == 0 ? codec_->disable() : startup_->request(step_index());
}

bool ConfigureDialogue::receive(const CanFrame& frame) noexcept {
  // One answer a cycle: a step that was reached in this cycle has no request on its way yet.
  if (expects_state() || failed_ || advanced_) return false;
  double found = 0.0;
  const Answer answer = startup_->check_answer(step_index(), frame, &found);
  if (answer == Answer::kNone) return false;
  failure_.answer = answer;
  failure_.found = found;
  repeat_ = answer == Answer::kNotYet;
  if (answer == Answer::kMissing) note_missing();
  if (answer == Answer::kRight || answer == Answer::kMissing) advance();
  if (answer == Answer::kWrong || answer == Answer::kRefused) failed_ = true;
  return true;
}

void ConfigureDialogue::receive_state(bool enabled) noexcept {
  if (step_ == 0 && !enabled) advance();
}

/// What is written and read back is missing twice.
void ConfigureDialogue::note_missing() noexcept {
  const bool noted = missing_count_ > 0 && missing_[missing_count_ - 1].reg == failure_.reg;
  if (!noted && missing_count_ < kMostMissing) missing_[missing_count_++] = failure_;
}

bool ConfigureDialogue::may_be_unanswered() const noexcept {
  if (done()) return false;
  return step_ == 0 ? !startup_->disable_is_answered() : !startup_->step(step_index()).answered;
}

void ConfigureDialogue::close_cycle() noexcept {
  const bool over = advanced_ || done() || failed_;
  advanced_ = false;
  if (over) return;
  const bool disabling = step_ == 0;
  if (!disabling && may_be_unanswered()) return go_to(step_ + 1);
  if (++waited_ < (disabling ? 1 : startup_->patience_cycles())) return;
  waited_ = 0;
  if (++attempts_ < kAttempts) return;
  if (may_be_unanswered()) return go_to(1);
  failed_ = true;
}

void ConfigureDialogue::advance() noexcept {
  go_to(step_ + 1);
  advanced_ = true;
}

void ConfigureDialogue::go_to(int step) noexcept {
  step_ = step;
  attempts_ = 0;
  waited_ = 0;
  repeat_ = false;
  failure_ = {};
  if (step_ == 0 || done()) return;
  const StartupStep next = startup_->step(step_index());
  failure_.reg = next.reg;
  failure_.expected = next.expected;
}

}  // namespace limber
