// All the driver keeps of one motor: its link, its dialogues, its watchdog, its counters.
#pragma once

#include <cstdint>

#include "drivers/configure.h"
#include "drivers/drive_states.h"
#include "drivers/enable.h"
#include "drivers/fallback.h"
#include "drivers/joint_link.h"
#include "drivers/reply_watch.h"

namespace limber {

/// Everything but the constructor is allowed inside the cycle.
class Drive {
 public:
  Drive(const JointConfig& joint, bool fd, double rate_hz, int bridged_cycles);

  /// The arm's state changed; `gravity` is what holds this joint, from the last accepted command.
  void enter(DriveState state, double gravity) noexcept;

  /// This cycle's one frame. `tau` counts in ON, `settling` in HOLD (the first 100 ms).
  CanFrame next_frame(DriveState state, double tau, bool settling) noexcept;
  void begin_cycle() noexcept;
  /// A frame with this motor's reply identifier.
  void receive(DriveState state, const CanFrame& frame) noexcept;
  void count_late() noexcept { ++late_; }
  void close_cycle(DriveState state, std::int64_t cycle) noexcept;
  /// The operator has seen it: the watchdogs start afresh.
  void acknowledge() noexcept { watch_.reset(); }

  /// Some valid answer came in this cycle, a state or what was asked for.
  bool answered() const noexcept { return answered_; }
  /// The last it said is that its power stage is off.
  bool disabled() const noexcept { return !link_.enabled(); }
  bool configured() const noexcept { return configure_.done(); }
  bool configuration_wrong() const noexcept { return configure_.failed(); }
  bool enabling_done() const noexcept { return enable_.done(link_); }
  std::int64_t missing_cycles() const noexcept { return watch_.missing(); }
  bool lost() const noexcept { return watch_.lost(); }
  /// Above 110 % of the velocity limit in three cycles in a row.
  bool too_fast() const noexcept { return fast_cycles_ >= 3; }
  /// Fit to be moved: answered, enabled, within its position limits and not too fast.
  bool healthy() const noexcept;
  /// The same but for being enabled.
  bool ready_to_enable() const noexcept;

  const JointLink& link() const noexcept { return link_; }
  const ConfigureDialogue& configuration() const noexcept { return configure_; }
  std::int32_t replies_late() const noexcept { return late_; }
  std::int32_t replies_lost() const noexcept { return missing_; }
  std::int32_t replies_invalid() const noexcept { return invalid_; }
  int bus() const noexcept { return link_.joint().drive.bus; }

 private:
  CanFrame poll() noexcept;

  JointLink link_;
  ConfigureDialogue configure_;
  EnableDialogue enable_;
  JointHold hold_;
  ReplyWatch watch_;
  int fast_cycles_ = 0;
  bool answered_ = false;
  std::int32_t late_ = 0;
  std::int32_t missing_ = 0;
  std::int32_t invalid_ = 0;
};

}  // namespace limber
