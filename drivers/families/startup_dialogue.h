// How one drive is found, and what is read from it and written to it before it may be enabled: one
// class a family, one object a drive. Its steps are taken in order, after a disable().
//
// After construction every member is free of allocation, locks, logs and exceptions, describe()
// aside.
#pragma once

#include <cstdint>
#include <string>

#include "drivers/can/can_frame.h"

namespace limber {

/// One register read, or written, before the drive may be enabled. `reg` is the family's own
/// numbering; CANopen: index << 8 | subindex.
struct StartupStep {
  std::uint32_t reg = 0;
  double expected = 0.0;
  bool answered = true;  ///< false: no reply exists; the next step shows if it arrived
};
enum class Answer : std::uint8_t {
  kNone,
  kRight,
  kNotYet,  ///< wrong, but it may still become right: request again
  kWrong,
  kRefused,  ///< `found` is the drive's reason
  kMissing,  ///< the drive has no such thing, and need not: a warning, and the next step
};

/// What the start-up dialogue failed at.
struct StartupFailure {
  std::uint32_t reg = 0;          ///< 0: the disabling
  Answer answer = Answer::kNone;  ///< the last one
  double found = 0.0;
  double expected = 0.0;
};

class StartupDialogue {
 public:
  virtual ~StartupDialogue() = default;

  // --- is it there? ---------------------------------------------------------------------------

  /// A request that every drive of the family answers, and that disturbs nothing.
  virtual CanFrame presence_request() const noexcept = 0;
  virtual bool is_presence(const CanFrame& frame) const noexcept = 0;
  /// Whether the frame answers presence_request() as this drive would, but with an identifier that
  /// is not its own: a setting of the drive that is easily forgotten.
  virtual bool has_wrong_reply_id(const CanFrame& frame) const noexcept {
    static_cast<void>(frame);
    return false;
  }
  /// Where that setting is: "Damiao: MST_ID, register 7".
  virtual const char* reply_id_setting() const noexcept { return ""; }

  // --- is it set as robot.yaml has it? --------------------------------------------------------

  /// Start of a cycle.
  virtual void begin_cycle() noexcept {}
  /// False if a drive that was not started yet does not answer a disable(): it is then tried, and
  /// the steps repeat it.
  virtual bool disable_is_answered() const noexcept { return true; }
  /// Cycles that an answer may take before the request is repeated.
  virtual int patience_cycles() const noexcept { return 1; }
  virtual int steps() const noexcept = 0;
  virtual StartupStep step(int index) const noexcept = 0;
  virtual CanFrame request(int index) const noexcept = 0;
  /// Whether the step reads a setting that must stay as it is, and that the drive also answers
  /// while it is on, one frame for one. Its answer is no reply to a command.
  virtual bool can_be_polled(int index) const noexcept {
    static_cast<void>(index);
    return false;
  }
  /// The frame as an answer to step `index`; `found` is set unless kNone.
  virtual Answer check_answer(int index, const CanFrame& frame, double* found) noexcept = 0;
  /// In words: "register 23 is 10, expected 28"; kMissing: what that means. Allocates: for
  /// messages, outside the cycle.
  virtual std::string describe(const StartupFailure& failure) const;
};

}  // namespace limber
