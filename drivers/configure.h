// Start-up dialogue with one drive: before anything is enabled, both sides must mean the same by
// the same bits, and the drive must stop by itself when it hears nothing.
//
//   disable -> the family's questions, one after the other -> done
//
// It starts with disable because a motor may still be enabled by a process that died; the enabled
// state of a stranger is never taken over. One frame a cycle. Allowed inside the cycle: everything
// but the constructor.
#pragma once

#include <cstdint>

#include "drivers/can/can_frame.h"
#include "drivers/families/drive_family.h"

namespace limber {

class ConfigureDialogue {
 public:
  /// The family outlives the dialogue.
  explicit ConfigureDialogue(DriveFamily* family) : family_(family) { start(); }

  void start() noexcept;

  /// The frame of this cycle.
  CanFrame next_frame() noexcept;
  /// True if a state reply, not an answer to a question, is expected.
  bool expects_state() const noexcept { return step_ == 0 || done(); }
  /// True if this cycle's frame may rightly stay without any answer.
  bool may_be_unanswered() const noexcept;
  /// An answer; false if it is none to the question asked.
  bool receive(const CanFrame& frame) noexcept;
  /// A state reply.
  void receive_state(bool enabled) noexcept;
  /// End of a cycle: a request unanswered for as long as the family is patient is repeated, three
  /// times at most.
  void close_cycle() noexcept;

  bool done() const noexcept { return step_ > family_->questions(); }
  bool failed() const noexcept { return failed_; }

  const StartupFailure& failure() const noexcept { return failure_; }

 private:
  static constexpr int kAttempts = 4;

  int question() const noexcept { return step_ - 1; }
  void advance() noexcept;
  void go_to(int step) noexcept;

  DriveFamily* family_;
  int step_ = 0;  ///< 0: disabling, i: question i - 1
  int attempts_ = 0;
  int waited_ = 0;         ///< cycles since the last attempt
  bool repeat_ = false;    ///< answered, but not yet rightly
  bool advanced_ = false;  ///< in this cycle
  bool failed_ = false;
  StartupFailure failure_;  ///< as it would be now
};

}  // namespace limber
