// The controller without its sockets: one JOINT_STATE in, one JOINT_TORQUE out. The process
// (controller/main.cc) and the lab call the same members, from one thread.
#pragma once

#include <cstdint>
#include <limber/compliance_gains_t.hpp>
#include <limber/compliance_goal_t.hpp>
#include <limber/controller_status_t.hpp>
#include <limber/hand_goal_t.hpp>
#include <limber/hand_state_t.hpp>
#include <limber/joint_command_t.hpp>
#include <limber/joint_state_t.hpp>
#include <limber/mode_request_t.hpp>
#include <limber/robot_info_t.hpp>
#include <limber/target_stream_t.hpp>
#include <limber/torque_overlay_t.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "controller/goals/stream/hand_knots.h"
#include "controller/hand/hand_control.h"
#include "controller/modes/supervisor.h"
#include "controller/output/torque_limiter.h"
#include "controller/request_outcome.h"
#include "controller/torque_cycle.h"
#include "controller/watches/encoder_watch.h"
#include "controller/watches/energy_watch.h"
#include "controller/watches/load_watch.h"
#include "controller/watches/start_watch.h"
#include "robots/loader/load_robot.h"
#include "scenarios/loader/scenario.h"

namespace limber {

struct ArmControllerOptions {
  std::int64_t controller =
      1;  ///< names this run; random in realtime, from the seed in lock step; never 0
  std::string law = "cartesian_impedance";  ///< the law ACTIVE starts with
  int bridged_cycles = 2;    ///< without a state or a joint's answer; one more: FAULT
  bool measure_time = true;  ///< false in lock step: no clock is read
  /// Every bus is simulated, whatever robot.yaml says, as in the lab. False: by robot.yaml.
  bool simulated = false;
  /// Gains that are known to be unstable are taken with a warning; of effect only where every bus
  /// is simulated. For those who want to see what happens.
  bool allow_unstable = false;
};

class ArmController {
 public:
  /// Throws ConfigError (unknown law, gains that do not fit the arm).
  ArmController(const LoadedRobot& robot, const ArmControllerOptions& options);

  /// One cycle: state in, torque out. Any state is answered: one that is stale, repeated (same seq:
  /// the same answer again, nothing advances; likewise a single one of another session) or not
  /// finite is handled as the supervisor's table says. No allocation, lock, log or exception.
  const joint_command_t& step(const joint_state_t& state) noexcept;

  /// Messages of the timeline that are due are applied in step(), before the law runs. `hold` and
  /// `active`, and all that follows them, wait up to 5 s for controller and drives to be ready.
  /// Set-up only.
  void set_timeline(const std::vector<TimedMessage>* timeline);

  /// What became of the timeline's requests in the last step().
  std::span<const RequestOutcome> timeline_outcomes() const noexcept { return outcomes_; }

  // Requests from outside, between cycles. A refused one changes nothing and is counted; the return
  // is the reason (nothing: accepted). Goals and gains act from the next step(), without a torque
  // jump.
  Refusal on_mode(const mode_request_t& request) noexcept;
  Refusal on_goal(const compliance_goal_t& goal) noexcept;
  Refusal on_gains(const compliance_gains_t& gains) noexcept;
  Refusal on_stream(const target_stream_t& stream) noexcept;
  Refusal on_overlay(const torque_overlay_t& overlay) noexcept;
  /// A message of a stream came again, or after a newer one.
  void count_stale_stream() noexcept { cycle_.stream().count_stale(); }
  Refusal on_hand(const hand_goal_t& goal) noexcept;

  /// A request was refused before it came here.
  void count_refusal() noexcept { ++status_.requests_refused; }
  /// Messages so far that could not be read.
  void count_undecodable(std::int64_t count) noexcept {
    status_.messages_undecodable = count + supervisor_.states().doubted();
  }

  /// Who holds the lease; 0: nobody.
  std::int64_t lease() const noexcept { return supervisor_.lease(); }
  /// Its holder is gone.
  void free_lease() noexcept { supervisor_.take_lease(0); }

  /// Realtime only: no new JOINT_STATE for this long. The supervisor enters FAULT; the next answer
  /// carries it.
  void on_silence() noexcept;

  const controller_status_t& status() const noexcept { return status_; }
  /// nullptr for an arm without a hand.
  const hand_state_t* hand_state() const noexcept { return hand_ ? &hand_->state() : nullptr; }
  /// Which arm this is, for tools.
  const robot_info_t& robot_info() const noexcept { return info_; }

 private:
  void apply_timeline(std::int64_t time_ns) noexcept;
  void watch_motion(const joint_state_t& state, double dt_s) noexcept;
  controller::Standby standby() const noexcept;
  void move_hand(controller::Activity activity, double dt_s) noexcept;
  void write_answer(const joint_state_t& state) noexcept;
  void write_gravity() noexcept;
  void write_status(std::int64_t started_ns) noexcept;
  void write_stream() noexcept;
  Refusal check_hand(const target_stream_t& stream) const noexcept;
  Refusal check_active(std::int64_t client) const noexcept;
  Refusal counted(Refusal refusal) noexcept;

  ArmControllerOptions options_;
  controller::Supervisor supervisor_;
  controller::TorqueCycle cycle_;
  controller::StartWatch start_watch_;
  controller::LoadWatch load_watch_;
  controller::EncoderWatch encoder_watch_;
  controller::EnergyWatch energy_watch_;
  controller::TorqueLimiter gravity_limiter_;
  std::optional<controller::HandControl> hand_;
  controller::HandKnots hand_knots_;
  bool was_engaged_ = false;
  std::optional<Timeline> timeline_;
  std::vector<RequestOutcome> outcomes_;  ///< room for all of the timeline
  double period_s_ = 0.0;
  joint_command_t answer_{};
  controller_status_t status_{};
  robot_info_t info_;
};

}  // namespace limber
