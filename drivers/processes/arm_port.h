// ArmDriver between its buses and LCM: what a cycle reads, waits for and publishes. The two runners
// work on it.
#pragma once

#include <cstdint>
#include <limber/controller_status_t.hpp>
#include <limber/driver_status_t.hpp>
#include <limber/joint_command_t.hpp>
#include <limber/joint_state_t.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/arm_plane/arm_plane.h"
#include "common/lcm_port.h"
#include "drivers/arm_driver.h"
#include "drivers/can/can_bus.h"
#include "drivers/processes/cycle_timing.h"
#include "drivers/processes/state_reporter.h"
#include "drivers/processes/wait_for_replies.h"
#include "robots/loader/robot.h"

namespace limber {

/// Messages on errors may allocate; all else is free of it after construction.
class ArmPort {
 public:
  /// Opens the arm plane and the buses and builds the driver. `user_plane` and `reporter` outlive
  /// this. Throws ConfigError.
  ArmPort(const Robot& robot, const ArmDriverOptions& options, LcmPort* user_plane,
          StateReporter* reporter);

  ArmDriver& driver() noexcept { return *driver_; }
  std::span<CanBus* const> buses() const noexcept { return bus_pointers_; }
  CycleTiming& timing() noexcept { return timing_; }

  /// Reads replies until the cycle is complete (true) or the deadline has come; CLOCK_MONOTONIC,
  /// ns.
  bool wait_for_replies(std::int64_t deadline_ns) {
    return limber::wait_for_replies(driver_.get(), bus_pointers_, deadline_ns);
  }
  void publish_state(const joint_state_t& state);
  /// Lock step, a datagram may be lost: the state once more, for the controller alone.
  void repeat_state();
  /// Passes the commands that have arrived to the driver.
  void read_commands() { arm_plane_.handle_waiting(); }
  /// Reads commands until one answers the state published last (true) or the deadline has come.
  bool wait_for_answer(std::int64_t deadline_ns);
  void publish_status();
  /// To the log: this process did nothing for so long. Allowed in the cycle.
  void note_stall(std::int64_t time_ns) noexcept { reporter_->note_stall(time_ns); }
  /// Keeps what goes over the arm plane; outlives this. Set-up only.
  void set_black_box(BlackBox* box) { arm_plane_.set_black_box(box); }

  /// DRIVER_STATUS as published last. `realtime_priority` is the process's to set.
  driver_status_t& status() noexcept { return status_; }
  const driver_status_t& status() const noexcept { return status_; }

 private:
  void on_command(const joint_command_t& command);
  void log_configuration(const joint_state_t& state);
  void log_problem(const std::string& problem);

  bool lockstep_;
  LcmPort* user_plane_;
  StateReporter* reporter_;
  ArmPlane arm_plane_;
  std::vector<std::unique_ptr<CanBus>> buses_;
  std::vector<CanBus*> bus_pointers_;
  std::unique_ptr<ArmDriver> driver_;

  const joint_state_t* published_ = nullptr;
  std::int64_t published_ns_ = 0;
  bool answered_ = false;          ///< the state published last
  bool controller_fault_ = false;  ///< the last command came from a controller in FAULT
  bool wrong_ = false;             ///< the configuration, by the state published last
  bool configuring_ = true;        ///< likewise
  std::string problem_logged_;     ///< told once, however often it is acknowledged
  CycleTiming timing_;
  driver_status_t status_{};
};

}  // namespace limber
