// The controller without its sockets: one JOINT_STATE in, one JOINT_TORQUE out. The process
// (controller/main.cc) and the lab call the same members, from one thread.
#pragma once

#include <cstdint>
#include <limber/compliance_gains_t.hpp>
#include <limber/compliance_goal_t.hpp>
#include <limber/controller_status_t.hpp>
#include <limber/joint_state_t.hpp>
#include <limber/joint_torque_t.hpp>
#include <limber/mode_request_t.hpp>
#include <memory>
#include <string>
#include <vector>

#include "robots/load_robot.h"
#include "scenarios/scenario.h"

namespace limber {

struct ArmControllerOptions {
  std::int64_t controller =
      1;  ///< names this run; random in realtime, from the seed in lock step; never 0
  std::string law = "cartesian_impedance";  ///< the law ACTIVE starts with
  int bridged_cycles = 2;    ///< without a state or a joint's answer; one more: FAULT
  bool measure_time = true;  ///< false in lock step: no clock is read
};

class ArmController {
 public:
  /// Throws ConfigError (unknown law, gains that do not fit the arm).
  ArmController(const LoadedRobot& robot, const ArmControllerOptions& options);
  ~ArmController();

  /// The cycle: state in, terms, law, null space, gravity, limits, torque out. Any state is
  /// answered: one that is stale, repeated (same seq: the same answer again, nothing advances),
  /// from another session or not finite is handled as the supervisor's table says. No allocation,
  /// lock, log or exception.
  const joint_torque_t& step(const joint_state_t& state) noexcept;

  /// Messages of the timeline that are due are applied at the start of step(), before the law runs.
  void set_timeline(const std::vector<TimedMessage>* timeline) noexcept;

  // Requests from outside, between cycles. A refused one changes nothing and is counted; the return
  // says why (nullptr: accepted). Goals and gains act from the next step(), without a torque jump.
  const char* on_mode(const mode_request_t& request) noexcept;
  const char* on_goal(const compliance_goal_t& goal) noexcept;
  const char* on_gains(const compliance_gains_t& gains) noexcept;

  /// Realtime only: no JOINT_STATE for this long. The supervisor enters FAULT; the next answer says
  /// so.
  void on_silence() noexcept;

  const controller_status_t& status() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Names in the law registry, in order of their index in controller_status_t.
std::vector<std::string> law_names();

}  // namespace limber
