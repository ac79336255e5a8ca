// The driver's cycle without its loop: commands to the motors, their replies, and the check of the
// controller's answer. The process (drivers/processes) and the lab call the same steps in the same
// order.
#pragma once

#include <cstdint>
#include <limber/driver_status_t.hpp>
#include <limber/joint_command_t.hpp>
#include <limber/joint_state_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "drivers/arm_drives.h"
#include "drivers/can/can_bus.h"
#include "drivers/controller_watch.h"
#include "drivers/drive/bus_end.h"
#include "drivers/drive/emergency_stop_link.h"
#include "drivers/drive/tip_sensor_link.h"
#include "drivers/drive_supervisor.h"
#include "drivers/gate/torque_gate.h"
#include "robots/loader/robot.h"

namespace limber {

struct ArmDriverOptions {
  std::int64_t session = 1;  ///< random in realtime, from the seed in lock step; never 0
  bool lockstep = false;     ///< each cycle ends with a TICK and is complete at the TOCK
  /// So many cycles in a row may go without an answer of the controller, or of a motor; the next
  /// one trips.
  int bridged_cycles = 2;
  std::int64_t first_cycle = 0;  ///< its number; more than 0 to see a count pass a limit
};

/// One cycle, at a fixed rate, is
///   transmit(t)  ->  poll() until complete() or out of time  ->  finish_cycle() = JOINT_STATE  ->
///   accept(JOINT_TORQUE)
/// After construction every member is free of allocation, locks, logs and exceptions.
class ArmDriver {
 public:
  /// `buses` in the order of robot.buses; they outlive the driver. Throws ConfigError: no drives,
  /// or replies that cannot come in time at robot.rate_hz (checked_bus_load).
  ArmDriver(const Robot& robot, const std::vector<CanBus*>& buses, const ArmDriverOptions& options);

  /// 1. Takes what came after the end of the last cycle, one cycle old, then sends one frame to
  /// every motor (and the TICK). `time_ns`: arm time of this cycle; `stamp_ns`: the same in the
  /// clock of the frames' stamps.
  void transmit(std::int64_t time_ns, std::int64_t stamp_ns) noexcept;
  /// 2. Reads the replies that have arrived.
  void poll() noexcept;
  /// True when every joint has answered, and the tip sensor, unless it has been silent for longer
  /// than is bridged (in lock step: when every bus has sent its TOCK).
  bool complete() const noexcept;
  /// Lock step, first cycle or a lost datagram: sends the TICK again. The simulator answers without
  /// advancing twice.
  void repeat_tick() noexcept;
  /// From here on the buses need receive only what drives and tip sensor of this arm send, and what
  /// anybody else sends to them; what was exchanged before is not counted. Before the first cycle;
  /// set-up only.
  void set_receive_filters();
  /// No reply is faster than this: what comes sooner after the start of a cycle answers the command
  /// before. In lock step it is computed; in real time it is 0 until it has been measured.
  void set_least_round_trip(std::int64_t time_ns) noexcept { least_round_trip_ns_ = time_ns; }
  /// After the start of a cycle, ns: what comes later belongs to the next one.
  std::int64_t reply_window_ns() const noexcept { return window_ns_; }
  /// 3. Closes the cycle: missing replies, watchdogs, drive states. The returned state is valid
  /// until the next call.
  const joint_state_t& finish_cycle() noexcept;
  /// 4. Judges an answer; returns VERDICT_* of driver_status_t. Only an accepted one has an effect:
  /// the next transmit() sends it.
  int accept(const joint_command_t& command) noexcept;

  /// Number of the controller that has the arm; 0: none.
  std::int64_t controller() const noexcept { return gate_.memory().controller; }

  /// Too many cycles took longer than their period: the drives hold the arm by themselves.
  /// `longest_ns`: of them.
  void report_overruns(std::int64_t longest_ns = 0) noexcept {
    overrun_ns_ = longest_ns;
    drives_.apply(DriveEvent::kOverrun);
  }

  /// Ends the session for good: drives that are enabled brake for 0.3 s, then are disabled, and
  /// commands have no effect any more. Keep cycling until shut_down() (true when every drive that
  /// answers reports disabled).
  void request_shut_down() noexcept { shutting_down_ = true; }
  bool shut_down() const noexcept { return shutting_down_ && drives_.all_off(); }

  /// The drive whose start-up dialogue failed, in words ("joint3: register 23 is 10, expected 28");
  /// empty if none did. Allocates: for messages, not for the cycle.
  std::string configuration_problem() const { return drives_.configuration_problem(); }

  /// What the start-up found missing in drives that may miss it ("joint3: object 1400h:05 is
  /// missing: ..."), and joints outside their limits; a line each. Allocates likewise.
  std::vector<std::string> configuration_warnings() const {
    return drives_.configuration_warnings();
  }
  /// Motors of the arm, counted along its joints.
  int motors() const noexcept { return motors_; }
  /// What motor 0, 1, .. is to be looked at for. Allowed in the cycle.
  DriveWarning warning(int motor) const noexcept { return drives_.warning(motor); }
  /// The same in words; "... no warning any more" if there is nothing. Allocates: for messages.
  std::string warning_text(int motor, const DriveWarning& warning) const {
    return drives_.warning_text(motor, warning);
  }
  /// What lies behind the fault of the last state: of a drive's error its drive_status, of
  /// contradicting feedback a Contradiction, of heat its temperature, of a lost bus its number << 8
  /// and BUS_*, of refused commands the last VERDICT_*, of overruns the longest in ms, of lost
  /// replies the cycles without one; else 0. Allowed in the cycle.
  std::uint16_t fault_detail() const noexcept;
  /// The same in words; "" if nothing is known beyond the fault. Allocates: for messages.
  std::string fault_text(int fault, int joint, std::uint16_t detail) const;

  /// Counters and states; the timing fields are left as they are.
  void fill_status(driver_status_t* status) const noexcept;

 private:
  void receive(bool before_commands) noexcept;
  void route(std::size_t bus, const CanFrame& frame, bool late) noexcept;
  void advance_shut_down() noexcept;
  void check_emergency_stop() noexcept;
  GateSituation situation() const noexcept;
  std::string lost_text(int joint, int cycles) const;
  std::string detail_text(int fault, std::uint16_t detail) const;

  double rate_hz_;
  int motors_;
  bool lockstep_;
  std::int64_t session_;
  std::vector<BusEnd> buses_;
  ArmDrives drives_;
  std::optional<TipSensorLink> tip_sensor_;
  std::optional<EmergencyStopLink> emergency_stop_;
  DriveSupervisor supervisor_;
  TorqueGate gate_;
  ControllerWatch controller_watch_;

  std::int64_t window_ns_;
  std::int64_t least_round_trip_ns_;
  std::int64_t cycle_ = -1;
  std::int64_t time_ns_ = 0;
  std::int64_t stamp_ns_ = 0;  ///< start of the cycle, in the clock of the frames' stamps
  int refused_for_ = driver_status_t::VERDICT_ACCEPTED;  ///< the third command in 0.1 s
  std::int64_t overrun_ns_ = 0;                          ///< the longest of the last in a row
  bool simulated_;  ///< in real time on virtual buses: another process of this machine
  bool shutting_down_ = false;
  joint_state_t state_{};  ///< as published last
};

}  // namespace limber
