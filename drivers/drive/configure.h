// Start-up dialogue with one drive: before anything is enabled, the settings of the drive must
// agree with robot.yaml, and its watchdog must be set.
//
//   disable -> the family's steps, one after the other -> done
//
// It starts with disable because a motor may still be enabled by a process that died; the enabled
// state of another process is never taken over. One frame a cycle. Allowed inside the cycle:
// everything but the constructor.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "drivers/can/can_frame.h"
#include "drivers/families/drive_family.h"

namespace limber {

class ConfigureDialogue {
 public:
  /// What the family holds outlives the dialogue.
  explicit ConfigureDialogue(const DriveFamily& family)
      : codec_(family.codec.get()), startup_(family.startup.get()) {
    start();
  }

  void start() noexcept;

  /// The frame of this cycle.
  CanFrame next_frame() noexcept;
  /// True if a state reply, not the answer to a step, is expected.
  bool expects_state() const noexcept { return step_ == 0 || done(); }
  /// True if this cycle's frame may rightly stay without any answer.
  bool may_be_unanswered() const noexcept;
  /// An answer; false if it does not belong to the present step.
  bool receive(const CanFrame& frame) noexcept;
  /// A state reply.
  void receive_state(bool enabled) noexcept;
  /// End of a cycle: a request unanswered for as long as the family is patient is repeated, three
  /// times at most.
  void close_cycle() noexcept;

  bool done() const noexcept { return step_ > startup_->steps(); }
  bool failed() const noexcept { return failed_; }

  const StartupFailure& failure() const noexcept { return failure_; }
  /// What the drive turned out not to have, and need not: for warnings.
  std::span<const StartupFailure> missing() const noexcept {
    return {missing_.data(), missing_count_};
  }

 private:
  static constexpr int kAttempts = 4;
  static constexpr std::size_t kMostMissing = 8;

  int step_index() const noexcept { return step_ - 1; }
  void advance() noexcept;
  void note_missing() noexcept;
  void go_to(int step) noexcept;

  DriveCodec* codec_;
  StartupDialogue* startup_;
  int step_ = 0;  ///< 0: disabling, i: step i - 1
  int attempts_ = 0;
  std::int64_t waited_ = 0;  ///< cycles since the last attempt
  bool repeat_ = false;      ///< answered, but the value is not there yet
  bool advanced_ = false;    ///< in this cycle
  bool failed_ = false;
  StartupFailure failure_;  ///< as it would be now
  std::array<StartupFailure, kMostMissing> missing_;
  std::size_t missing_count_ = 0;
};

}  // namespace limber
