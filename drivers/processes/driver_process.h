// limber-driver without its command line: the arm's clock, between the buses and LCM.
#pragma once

#include <csignal>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/black_box/black_box.h"
#include "common/lcm_port.h"
#include "common/pace.h"
#include "common/realtime.h"
#include "common/run_lock.h"
#include "drivers/processes/arm_port.h"
#include "drivers/processes/state_reporter.h"
#include "robots/loader/robot.h"

namespace limber {

struct DriverProcessOptions {
  std::string robot = "openarm";
  std::map<std::string, std::string> buses;  ///< name in robot.yaml -> address to use instead
  double rate_hz = 0.0;                      ///< 0: as in robot.yaml
  Pace pace = Pace::kRealtime;
  std::vector<std::int64_t> readers = {};  ///< processes that a run without a clock waits for
  std::int64_t session = 0;                ///< identifies this run, by run_id()
  std::int64_t cycles = 0;                 ///< 0: for ever
  double duration_s = 0.0;                 ///< arm time; 0: for ever
  int realtime_priority = 80;              ///< 0: none is requested
  double patience_s = 30.0;                ///< how long to wait for motors, simulator, controller
};

class DriverProcess {
 public:
  /// Loads the robot, locks its buses and the arm plane, opens LCM and the buses, requests
  /// real-time priority, builds the driver. Throws ConfigError.
  explicit DriverProcess(const DriverProcessOptions& options);

  /// Waits for the motors, then cycles until the end or until `stop` is set, and shuts the arm down
  /// (see the runners). Returns an exit code: kExitFailed if motors,
  /// simulator or controller are silent.
  int run(const volatile std::sig_atomic_t& stop);

 private:
  bool lockstep() const noexcept { return in_lockstep(options_.pace); }
  bool run_cycles(const volatile std::sig_atomic_t& stop);
  /// Adapters against robot.yaml: warns in the log, throws ConfigError for what is wrong.
  void check_interfaces() const;
  /// Throws ConfigError: somebody else commands a motor of this arm.
  void check_bus_is_free();
  /// Round trips of the roll call. Throws ConfigError if a reply cannot come in its cycle.
  void measure_delay();
  void log_start() const;
  void log_end() const;

  DriverProcessOptions options_;
  Robot robot_;
  std::vector<RunLock> locks_;  ///< on the arm plane and every bus: nobody else may drive them
  std::unique_ptr<BlackBox> black_box_;
  // In this order: the reporter's thread keeps normal priority.
  StateReporter reporter_;
  LcmPort user_plane_;
  RealtimeGrant grant_;
  ArmPort port_;
};

}  // namespace limber
