// limber-driver without its command line: the arm's clock, between the buses and LCM.
#pragma once

#include <csignal>
#include <cstdint>
#include <limber/driver_status_t.hpp>
#include <limber/joint_state_t.hpp>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/latency_histogram.h"
#include "common/lcm_port.h"
#include "common/realtime.h"
#include "drivers/arm_driver.h"
#include "drivers/can/can_bus.h"
#include "drivers/overrun_watch.h"
#include "drivers/state_reporter.h"
#include "robots/robot.h"

namespace limber {

struct DriverProcessOptions {
  std::string robot = "openarm";
  std::map<std::string, std::string> buses;  ///< name in robot.yaml -> address to use instead
  double rate_hz = 0.0;                      ///< 0: what robot.yaml says
  bool lockstep = false;
  std::int64_t session = 0;    ///< 0: random in realtime, 1 in lock step
  std::int64_t cycles = 0;     ///< 0: for ever
  double duration_s = 0.0;     ///< arm time; 0: for ever
  int realtime_priority = 80;  ///< 0: do not ask
  double patience_s = 30.0;    ///< how long to wait for motors, simulator, controller
};

/// Exit statuses of the process. Errors of set-up (2) are ConfigError.
inline constexpr int kExitDone = 0;
inline constexpr int kExitNobodyThere = 3;

class DriverProcess {
 public:
  /// Loads the robot, opens LCM and the buses, asks for real-time priority, builds the driver.
  /// Throws ConfigError.
  explicit DriverProcess(const DriverProcessOptions& options);

  /// Waits for the motors, then cycles until the end or until `stop` is set. Then the arm is shut
  /// down: drives that are enabled brake for 0.3 s and are disabled (in lock step the run simply
  /// ends: the time of the simulated arm stands still). Returns the exit status.
  int run(const volatile std::sig_atomic_t& stop);

 private:
  void say_start() const;
  bool finished(const volatile std::sig_atomic_t& stop) const;

  void run_realtime(const volatile std::sig_atomic_t& stop);
  void realtime_cycle();
  void wait_for_replies(std::int64_t deadline_ns);
  void wait_for_answer(std::int64_t deadline_ns);

  int run_lockstep(const volatile std::sig_atomic_t& stop);
  bool lockstep_replies(const volatile std::sig_atomic_t& stop);
  bool lockstep_answer(const volatile std::sig_atomic_t& stop);

  void on_torque(const joint_torque_t& command);
  void publish_state(const joint_state_t& state);
  void tell_configuration_problem(const joint_state_t& state);
  void publish_status();
  void say_end() const;

  DriverProcessOptions options_;
  Robot robot_;
  int bridged_cycles_ = 2;
  std::int64_t period_ns_ = 0;
  std::int64_t session_ = 0;
  RealtimeGrant grant_;
  std::unique_ptr<StateReporter> reporter_;
  std::unique_ptr<LcmPort> user_plane_;
  std::unique_ptr<LcmPort> arm_plane_;
  std::vector<std::unique_ptr<CanBus>> buses_;
  std::vector<CanBus*> bus_pointers_;
  std::unique_ptr<ArmDriver> driver_;

  PeriodicLoop loop_;
  OverrunWatch overruns_;
  LatencyHistogram lateness_;
  LatencyHistogram answers_;
  std::int64_t late_cycles_ = 0;
  std::int64_t first_ns_ = 0;  ///< monotonic time of cycle 0
  std::int64_t cycle_ = 0;
  const joint_state_t* published_ = nullptr;
  std::int64_t published_ns_ = 0;
  bool answered_ = false;  ///< the present state
  bool told_ = false;      ///< what is wrong with the configuration
  driver_status_t status_{};
};

}  // namespace limber
