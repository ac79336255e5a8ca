// All the driver keeps of one motor: its link, its dialogues, its watchdog, its counters.
#pragma once

#include <cstdint>
#include <string>

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

  /// The arm's state changed; `held` is the torque that the motor goes on making in HOLD.
  void enter(DriveState state, double held) noexcept;

  /// This cycle's one frame. `tau` counts in ON, `settling` in HOLD (the first 100 ms).
  CanFrame next_frame(DriveState state, double tau, bool settling) noexcept;
  void begin_cycle() noexcept;
  /// A frame of this motor's.
  void receive(DriveState state, const CanFrame& frame) noexcept;
  /// One that came after its cycle. An answer to a question is as good as ever, a state is not.
  void receive_late(DriveState state, const CanFrame& frame) noexcept;
  void close_cycle(DriveState state, std::int64_t cycle) noexcept;
  /// The operator has seen it: the watchdogs start afresh.
  void acknowledge() noexcept { watch_.reset(); }

  /// Some valid answer came in this cycle, a state or what was asked for.
  bool answered() const noexcept { return answered_; }
  bool enabled() const noexcept { return link_.enabled(); }
  /// The last it said is that its power stage is off.
  bool disabled() const noexcept { return !link_.enabled(); }
  bool failed() const noexcept { return link_.drive_error(); }
  bool configured() const noexcept { return configure_.done(); }
  bool configuration_wrong() const noexcept { return configure_.failed(); }
  bool enabling_done() const noexcept { return enable_.done(link_); }
  std::int64_t missing_cycles() const noexcept { return watch_.missing(); }
  bool lost() const noexcept { return watch_.lost(); }

  const JointLink& link() const noexcept { return link_; }
  /// Why configuration_wrong(), in words. Allocates: for messages, outside the cycle.
  std::string configuration_problem() const { return link_.describe(configure_.failure()); }
  std::int32_t replies_late() const noexcept { return late_; }
  std::int32_t replies_lost() const noexcept { return missing_; }
  std::int32_t replies_invalid() const noexcept { return invalid_; }
  int bus() const noexcept { return link_.joint().drive.bus; }

 private:
  CanFrame poll() noexcept;
  /// A question of the start-up dialogue is open.
  bool asked(DriveState state) const noexcept {
    return state == DriveState::kConfiguring && !configure_.expects_state();
  }

  JointLink link_;
  ConfigureDialogue configure_;
  EnableDialogue enable_;
  JointHold hold_;
  ReplyWatch watch_;
  bool answered_ = false;
  std::int32_t late_ = 0;
  std::int32_t missing_ = 0;
  std::int32_t invalid_ = 0;
};

}  // namespace limber
