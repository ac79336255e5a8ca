// The simulator as a process: buses on one side, the user plane of LCM on the other, time in
// between.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <limber/joint_state_t.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/latency_histogram.h"
#include "common/lcm_port.h"
#include "drivers/can/can_bus.h"
#include "sim/simulator.h"

namespace limber {

struct SimProcessOptions {
  SimulatorOptions simulator;
  double duration_s = 0.0;  ///< simulated time after which to end; 0: until told to stop
  int priority = 0;         ///< SCHED_FIFO priority to ask for in realtime; 0: do not ask
};

/// Opens the robot's buses as they are named in `robot`. Throws ConfigError. Set-up only.
std::vector<std::unique_ptr<CanBus>> open_buses(const Robot& robot);

/// Publishes SIM_TRUTH after every control period; obeys PUSH and SCENARIO_EVENT.
class SimProcess {
 public:
  /// `timeline` may be empty and outlives the process. Throws ConfigError.
  SimProcess(const LoadedRobot& robot, const std::vector<TimedMessage>* timeline,
             const SimProcessOptions& options);

  /// Returns when `stop` is set or the duration is over.
  void run(const std::atomic<bool>& stop);

 private:
  void run_lockstep(const std::atomic<bool>& stop);
  void run_realtime(const std::atomic<bool>& stop);
  void subscribe();
  void catch_up(std::int64_t now_ns);
  void learn_arm_time(const joint_state_t& state);
  void publish_truth();
  void complain(const char* what);
  void report() const;
  bool over() const noexcept { return end_ns_ > 0 && simulator_.sim_time_ns() >= end_ns_; }

  std::string name_;
  SimProcessOptions options_;
  std::string scheduling_;  // asked for before user_: LCM's thread inherits it
  std::vector<std::unique_ptr<CanBus>> buses_;
  Simulator simulator_;
  LcmPort user_;
  std::vector<int> descriptors_;
  std::int64_t end_ns_;

  // Realtime: simulated time 0 on CLOCK_MONOTONIC; simulated time minus arm time.
  std::int64_t start_ns_ = 0;
  std::int64_t session_ = 0;
  bool anchored_ = false;
  std::int64_t arm_offset_ns_ = 0;
  LatencyHistogram lateness_;
  std::int64_t dropped_ns_ = 0;
  std::int64_t drops_ = 0;
  std::int64_t complained_ns_ = 0;
};

}  // namespace limber
