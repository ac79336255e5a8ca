#include "drivers/configure.h"

namespace limber {

void ConfigureDialogue::start() noexcept {
  step_ = 0;
  attempts_ = 0;
  advanced_ = false;
  failed_ = false;
  failure_ = {};
}

CanFrame ConfigureDialogue::next_frame() noexcept {
  if (done()) return family_->state_request();
  return step_ == 0 ? family_->disable() : family_->ask(question());
}

bool ConfigureDialogue::receive(const CanFrame& frame) noexcept {
  // One answer a cycle: a step that was reached in this cycle has not been asked for yet.
  if (expects_state() || failed_ || advanced_) return false;
  double found = 0.0;
  switch (family_->judge(question(), frame, &found)) {
    case Answer::kNone:
      return false;
    case Answer::kRight:
      advance();
      break;
    case Answer::kWrong:
      fail(true, found);
      break;
  }
  return true;
}

void ConfigureDialogue::receive_state(bool enabled) noexcept {
  if (step_ == 0 && !enabled) advance();
}

void ConfigureDialogue::close_cycle() noexcept {
  if (!advanced_ && !done() && !failed_ && ++attempts_ >= kAttempts) fail(false, 0.0);
  advanced_ = false;
}

void ConfigureDialogue::fail(bool answered, double found) noexcept {
  failed_ = true;
  const StartupQuestion asked = step_ == 0 ? StartupQuestion{} : family_->question(question());
  failure_ = {asked.reg, answered, found, asked.expected};
}

void ConfigureDialogue::advance() noexcept {
  ++step_;
  attempts_ = 0;
  advanced_ = true;
}

}  // namespace limber
