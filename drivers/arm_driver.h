// The driver's cycle without its loop: what goes to the motors, what comes back, who is obeyed. The
// process (drivers/main.cc) and the lab call the same five steps in the same order.
#pragma once

#include <cstdint>
#include <limber/driver_status_t.hpp>
#include <limber/joint_state_t.hpp>
#include <limber/joint_torque_t.hpp>
#include <memory>
#include <string>
#include <vector>

#include "drivers/can/can_bus.h"
#include "robots/robot.h"

namespace limber {

struct ArmDriverOptions {
  std::int64_t session = 1;  ///< random in realtime, from the seed in lock step; never 0
  bool lockstep = false;     ///< end each cycle with a TICK, know it complete by the TOCK
  /// So many cycles in a row may go without an answer of the controller, or of a motor; the next
  /// one trips.
  int bridged_cycles = 2;
};

/// One cycle, at a fixed rate, is
///   transmit(t)  ->  poll() until complete() or out of time  ->  finish_cycle() = JOINT_STATE  ->
///   accept(JOINT_TORQUE)
/// After construction every member is free of allocation, locks, logs and exceptions.
class ArmDriver {
 public:
  /// `buses` in the order of robot.buses; they outlive the driver. Throws ConfigError: no drives,
  /// or a predicted bus load above 90 % at robot.rate_hz.
  ArmDriver(const Robot& robot, std::vector<CanBus*> buses, const ArmDriverOptions& options);
  ~ArmDriver();

  /// 1. Counts stragglers of the last cycle as late, then sends one frame to every motor (and the
  /// TICK).
  void transmit(std::int64_t time_ns) noexcept;
  /// 2. Takes the replies that have arrived.
  void poll() noexcept;
  /// True when every joint has answered, and the tip sensor, unless it has been silent for longer
  /// than is bridged (in lock step: when every bus has sent its TOCK).
  bool complete() const noexcept;
  /// Lock step, first cycle or a lost datagram: sends the TICK again. The simulator answers without
  /// advancing twice.
  void repeat_tick() noexcept;
  /// 3. Closes the cycle: missing replies, watchdogs, drive state machine. The returned state is
  /// valid until transmit().
  const joint_state_t& finish_cycle() noexcept;
  /// 4. Judges an answer; returns VERDICT_*. Only an accepted one has an effect: it is sent by the
  /// next transmit().
  int accept(const joint_torque_t& command) noexcept;

  /// Asks for the arm to be held by the drives themselves, whatever the controller says (operator,
  /// overrun).
  void request_hold(int fault) noexcept;

  /// Ends the session for good: drives that are enabled brake for 0.3 s, then are disabled; the
  /// controller is not heard any more. Keep cycling until shut_down() (true when every drive that
  /// answers reports disabled).
  void request_shut_down() noexcept;
  bool shut_down() const noexcept;

  /// The drive whose start-up dialogue failed, in words ("joint3: register 23 is 10, expected 28");
  /// empty if none did. Allocates: for messages, outside the cycle.
  std::string configuration_problem() const;

  /// Counters and states; timing fields are left for the process to fill.
  void fill_status(driver_status_t* status) const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace limber
