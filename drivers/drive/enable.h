// Enabling one drive: clear a latched error if there is one, command zero torque so that no
// set-point of an earlier run is left in the drive, enable, and wait until the drive reports it.
#pragma once

#include "drivers/can/can_frame.h"
#include "drivers/drive/joint_link.h"

namespace limber {

/// One frame a cycle; a drive's reply shows its state before the frame took effect, so each step is
/// confirmed by the reply to the next. Allowed inside the cycle.
class EnableDialogue {
 public:
  void start(const JointLink& link) noexcept {
    step_ = link.drive_error() ? Step::kClear : Step::kZero;
  }

  CanFrame next_frame(JointLink* link) const noexcept {
    switch (step_) {
      case Step::kClear:
        return link->clear_error();
      case Step::kEnable:
        return link->enable();
      case Step::kZero:
      case Step::kConfirm:
        break;
    }
    return link->torque(0.0);
  }

  /// End of a cycle. Without a reply the step is repeated.
  void close_cycle(const JointLink& link) noexcept {
    if (!link.fresh()) return;
    switch (step_) {
      case Step::kClear:
        step_ = Step::kZero;
        break;
      case Step::kZero:
        step_ = link.drive_error() ? Step::kClear : Step::kEnable;
        break;
      case Step::kEnable:
        step_ = Step::kConfirm;
        break;
      case Step::kConfirm:
        if (!link.enabled()) step_ = link.drive_error() ? Step::kClear : Step::kEnable;
        break;
    }
  }

  bool done(const JointLink& link) const noexcept {
    return step_ == Step::kConfirm && link.fresh() && link.enabled() && !link.ignores_target();
  }

 private:
  enum class Step { kClear, kZero, kEnable, kConfirm };
  Step step_ = Step::kZero;
};

}  // namespace limber
