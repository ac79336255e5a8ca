// One motor as the driver sees it: link, dialogues, watchdog, counters.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "drivers/drive/configure.h"
#include "drivers/drive/drive_table.h"
#include "drivers/drive/drive_warning.h"
#include "drivers/drive/enable.h"
#include "drivers/drive/fallback.h"
#include "drivers/drive/feedback_watch.h"
#include "drivers/drive/joint_link.h"
#include "drivers/drive/reply_watch.h"
#include "drivers/drive/settings_watch.h"

namespace limber {

/// Everything but the constructor is allowed inside the cycle.
class Drive {
 public:
  Drive(const JointConfig& joint, bool fd, double rate_hz, int bridged_cycles);

  /// The arm's state changed. In FALLBACK the motor goes from the torque `present` to `held`, N m.
  void enter(DriveState state, double present, double held) noexcept;

  /// This cycle's one frame. `tau` counts in ON, `settling` in FALLBACK (the first 100 ms).
  CanFrame next_frame(DriveState state, double tau, bool settling) noexcept;
  /// What follows it: see DriveCodec::part_requests().
  std::span<const CanFrame> part_requests(DriveState state) const noexcept {
    if (awaits_answer(state)) return {};
    return link_.family().codec->part_requests();
  }
  /// One of the drive's settings is asked for, besides; see SettingsWatch.
  bool ask_for_setting(CanFrame* request) noexcept { return settings_->request(request); }
  void begin_cycle() noexcept;
  /// A frame of somebody else on its bus.
  void record_foreign(const CanFrame& frame) noexcept { link_.record_foreign(frame); }
  /// A frame of this motor's.
  void receive(DriveState state, const CanFrame& frame) noexcept;
  /// One that answers the command of the cycle before: a state is one cycle old.
  void receive_late(DriveState state, const CanFrame& frame) noexcept;
  /// `time_s`: arm time of the cycle.
  void close_cycle(DriveState state, std::int64_t cycle, double time_s) noexcept;
  /// The operator has acknowledged the fault: the watchdogs start afresh.
  void acknowledge() noexcept {
    watch_.reset();
    link_.clear_jump();
    invalid_window_.clear();
    often_invalid_ = false;
  }

  /// Some valid answer came in this cycle, a state or one of the start-up.
  bool answered() const noexcept { return answered_; }
  /// By the last reply, the power stage is on.
  bool enabled() const noexcept { return link_.enabled(); }
  bool failed() const noexcept {
    return link_.drive_error() || ignores_target() || setting_changed();
  }
  /// Enabled, but in three states in a row it did not execute its target.
  bool ignores_target() const noexcept { return ignoring_cycles_ >= 3; }
  /// A setting is no longer what the start-up left. Allowed in every thread.
  bool setting_changed() const noexcept { return settings_->changed(); }
  /// While it has power: velocity or torque contradict the rest of what it reports.
  Contradiction contradiction() const noexcept { return feedback_.found(); }
  /// Above limit_temperature_degC in ten replies in a row, until it is cooler.
  bool too_hot() const noexcept { return heat_limit_.hot(); }
  DriveWarning warning() const noexcept;
  bool configured() const noexcept { return configure_.done(); }
  bool configuration_wrong() const noexcept { return configure_.failed(); }
  bool enabling_done() const noexcept { return enable_.done(link_); }
  std::int64_t missing_cycles() const noexcept { return watch_.missing(); }
  /// In too many cycles within a second (ten on a wire, see LossWindow) replies were doubled or
  /// could not be understood, or one of these was the last of too many cycles without a state.
  bool often_invalid() const noexcept { return often_invalid_; }
  /// After replies were often_invalid(), one of several senders is believed: an angle is one again
  /// when two readings in a row agree, without another reply beside them.
  bool credible() const noexcept { return !often_invalid_ || agreeing_cycles_ >= kAgreeing; }
  bool lost() const noexcept { return watch_.lost(); }

  const JointLink& link() const noexcept { return link_; }
  /// Why configuration_wrong(), in words. Allocates: for messages, outside the cycle.
  std::string configuration_problem() const { return link_.describe(configure_.failure()); }
  /// Which setting_changed(), likewise. Allowed in every thread.
  std::string changed_setting() const { return link_.describe(settings_->failure()); }
  /// What the drive lacks without being wrong, likewise.
  std::vector<std::string> configuration_warnings() const {
    std::vector<std::string> warnings;
    for (const StartupFailure& missing : configure_.missing())
      warnings.push_back(link_.describe(missing));
    return warnings;
  }
  std::int64_t replies_late() const noexcept { return late_; }
  std::int64_t replies_lost() const noexcept { return missing_; }
  std::int64_t replies_invalid() const noexcept { return invalid_; }
  /// Index into Robot::buses.
  std::size_t bus() const noexcept { return static_cast<std::size_t>(link_.joint().drive.bus); }

 private:
  static constexpr int kAgreeing = 2;

  CanFrame poll() noexcept;
  CanFrame hold(bool settling) noexcept;
  void expect_angle(DriveState state) noexcept;
  void count_invalid() noexcept;
  void check_feedback(DriveState state, double time_s) noexcept;
  /// A start-up step waits for its answer.
  bool awaits_answer(DriveState state) const noexcept {
    return state == DriveState::kConfiguring && !configure_.expects_state();
  }

  JointLink link_;
  ConfigureDialogue configure_;
  std::unique_ptr<SettingsWatch> settings_;  // atomics do not move
  EnableDialogue enable_;
  Fallback fallback_;
  DriveState entered_ = DriveState::kConfiguring;
  ReplyWatch watch_;
  FeedbackWatch feedback_;
  HeatWatch warmth_;
  HeatWatch heat_limit_;
  std::int64_t ignoring_cycles_ = 0;
  bool answered_ = false;
  std::int64_t late_ = 0;
  std::int64_t missing_ = 0;
  LossWindow invalid_window_;
  int cycles_per_second_;
  bool often_invalid_ = false;
  std::int64_t agreeing_cycles_ = 0;
  std::int64_t cycle_ = 0;
  std::int64_t invalid_cycle_ = -1;  ///< of the last reply that could not be understood
  bool late_answer_ = false;         ///< of the start-up, in this cycle
  std::int64_t silent_cycles_ = 0;   ///< in the start-up
  bool counted_missing_ = false;     ///< in the last cycle; unless the reply comes late
  std::int64_t invalid_ = 0;
};

}  // namespace limber
