// Are a drive's settings still what its start-up found or wrote? Its maker's tool on another wire,
// or a reset, may change them past the bus.
#pragma once

#include <atomic>

#include "drivers/families/startup_dialogue.h"

namespace limber {

/// Reads the settings of the start-up again, one a request, while the drive is on. A value that is
/// wrong twice in a row has been changed. A request without an answer is repeated, and says
/// nothing: silent drives are noticed otherwise. Allowed inside the cycle.
class SettingsWatch {
 public:
  /// `startup` outlives the watch.
  explicit SettingsWatch(StartupDialogue* startup) noexcept : startup_(startup) {}

  /// The settings are about to be compared, or written, by the start-up.
  void start() noexcept {
    step_ = kNone;
    waits_ = false;
    wrong_ = 0;
    changed_.store(kNone, std::memory_order_relaxed);
  }
  /// The next request; false if the drive has nothing to be read while it is on.
  bool request(CanFrame* frame) noexcept {
    const int steps = startup_->steps();
    if (!waits_ && wrong_ == 0) ++step_;
    for (int tried = 0; tried < steps; ++tried, ++step_) {
      step_ %= steps;
      if (!startup_->can_be_polled(step_)) continue;
      waits_ = true;
      *frame = startup_->request(step_);
      return true;
    }
    step_ = kNone;
    return false;
  }
  /// True if the frame answers the last request, also if it does so once more.
  bool receive(const CanFrame& frame) noexcept {
    if (step_ == kNone) return false;
    double found = 0.0;
    const Answer answer = startup_->check_answer(step_, frame, &found);
    if (answer == Answer::kNone) return false;
    if (!waits_) return true;
    waits_ = false;
    const bool wrong = answer == Answer::kWrong || answer == Answer::kNotYet;
    wrong_ = wrong ? wrong_ + 1 : 0;
    if (wrong_ == kWrongAnswers && !changed()) {
      found_.store(found, std::memory_order_relaxed);
      changed_.store(step_, std::memory_order_release);
    }
    return true;
  }

  /// Until the start-up is repeated. Allowed in every thread.
  bool changed() const noexcept { return changed_.load(std::memory_order_acquire) != kNone; }
  /// What changed(); allowed in every thread.
  StartupFailure failure() const noexcept {
    const int step = changed_.load(std::memory_order_acquire);
    if (step == kNone) return {};
    const StartupStep planned = startup_->step(step);
    return {planned.reg, Answer::kWrong, found_.load(std::memory_order_relaxed), planned.expected};
  }

 private:
  static constexpr int kNone = -1;
  static constexpr int kWrongAnswers = 2;

  StartupDialogue* startup_;
  int step_ = kNone;  ///< asked for last
  bool waits_ = false;
  int wrong_ = 0;  ///< answers in a row
  // Read by the thread that logs.
  std::atomic<int> changed_ = kNone;  ///< the step
  std::atomic<double> found_ = 0.0;
};

}  // namespace limber
