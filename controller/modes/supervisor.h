// Decides the mode: what the state stream, the drives and the clients mean for it.
#pragma once

#include <cmath>
#include <cstdint>
#include <limber/joint_state_t.hpp>
#include <limber/mode_request_t.hpp>
#include <optional>

#include "controller/kinds/refusal.h"
#include "controller/modes/mode_table.h"
#include "controller/modes/state_judge.h"
#include "controller/watches/preload_watch.h"

namespace limber::controller {

/// The mode table with its memory: timers, the lease, whether the drives follow. It computes no
/// torque. All members may be called in the cycle.
class Supervisor {
 public:
  static constexpr int kSteadyStates = 100;
  static constexpr std::int64_t kDrivesOnWithin_ns = 3'000'000'000;
  /// Outside ACTIVE and SOFT_STOP the lease of a client ends so long after its last request.
  static constexpr std::int64_t kLease_ns = 10'000'000'000;

  Supervisor(int joints, int bridged_cycles, const JointFlags& flags = {},
             const PreloadWatch& preload = {})
      : judge_(joints, bridged_cycles, flags), preload_(preload) {}

  /// Each state once, before anything else. Nothing happens if the state is a repetition.
  StateJudgement on_state(const joint_state_t& state) noexcept;
  /// No new state for too long: the next one may have any number.
  void forget_sequence() noexcept { judge_.forget_sequence(); }
  /// Nothing: obeyed, else why not.
  Refusal on_mode(const mode_request_t& request) noexcept;
  /// Too early: the request would be refused because controller or drives are still starting, or
  /// springs still slack.
  bool not_yet(const mode_request_t& request) const noexcept;
  /// Nothing if the client may send goals and gains: it holds the lease, or nobody does.
  Refusal check_client(std::int64_t client) const noexcept;
  /// The client was obeyed: the lease is its from now on.
  void take_lease(std::int64_t client) noexcept {
    lease_ = client;
    lease_renewed_ns_ = time_ns_;
  }
  std::int64_t lease() const noexcept { return lease_; }
  /// A goal was accepted. If it is valid for a time, s, and no other is accepted within it, the arm
  /// comes to rest; 0: it lasts.
  void take_goal(double valid_for_s) noexcept {
    goal_ends_ns_.reset();
    if (valid_for_s > 0.0) goal_ends_ns_ = time_ns_ + std::llround(1e9 * valid_for_s);
  }
  /// Something the cycle noticed, at a joint or (-1) at none. False if the table has no row for it.
  bool raise(Event event, int joint = -1) noexcept;

  Mode mode() const noexcept { return mode_; }
  /// REASON_* of the last transition that nobody asked for; gone after an acknowledgement.
  std::int8_t reason() const noexcept { return reason_; }
  /// The joint that caused it; -1: none.
  int reason_joint() const noexcept { return reason_joint_; }
  /// HOLD, ACTIVE or SOFT_STOP: the drives are wanted.
  bool powered_mode() const noexcept;
  /// A powered mode with the drives on: the torque of the cycle reaches the motors.
  bool engaged() const noexcept { return engaged_; }
  /// Drives that follow torque commands, and nobody who wants them to be off.
  bool drives_carry() const noexcept { return drives_on() && !idle_requested_; }
  bool drives_on() const noexcept { return drive_state_ == joint_state_t::DRIVE_ON; }
  /// Enabled drives that the driver lets hold or brake by themselves.
  bool drives_hold() const noexcept {
    return drive_state_ == joint_state_t::DRIVE_HOLD || drive_state_ == joint_state_t::DRIVE_DAMP;
  }
  /// REQUEST_* to the driver in this cycle.
  std::int8_t drive_request() const noexcept;
  const StateJudge& states() const noexcept { return judge_; }

 private:
  void count_steady(const StateJudgement& judgement) noexcept;
  void watch_drives(bool enabling_failed) noexcept;
  void enter(Mode mode) noexcept;
  bool lease_is_over() const noexcept;

  StateJudge judge_;
  PreloadWatch preload_;
  Mode mode_ = Mode::kBoot;
  std::int8_t reason_ = controller_status_t::REASON_NONE;
  int reason_joint_ = -1;
  std::int64_t lease_ = 0;
  std::int64_t lease_renewed_ns_ = 0;
  std::optional<std::int64_t> goal_ends_ns_;  ///< of a goal that is valid for a time
  std::int64_t steady_ = 0;                   ///< good states in a row
  bool acknowledged_ = false;                 ///< a fault that the drives are still in
  bool engaged_ = false;
  bool idle_requested_ = false;
  bool starting_ = false;  ///< the drives repeat their start-up, and no joint was heard since
  std::int8_t drive_state_ = joint_state_t::DRIVE_CONFIGURING;
  bool stop_pressed_ = false;
  bool slack_ = false;
  std::int64_t time_ns_ = 0;
  std::int64_t entered_ns_ = 0;
};

}  // namespace limber::controller
