// Simulated time by the clock of this machine.
#pragma once

#include <csignal>
#include <cstdint>
#include <limber/joint_state_t.hpp>

#include "common/latency_histogram.h"
#include "sim/processes/sim_port.h"

namespace limber::sim {

/// Simulated time 0 is the start of run(). JOINT_STATE gives the arm time that belongs to it.
class RealtimeRunner {
 public:
  /// The port outlives the runner.
  explicit RealtimeRunner(SimPort* port);

  /// Until `stop` is set or simulated time has reached `end_ns`.
  void run(std::int64_t end_ns, const volatile std::sig_atomic_t& stop);
  /// To the log: how late steps were and what was dropped.
  void report() const;

 private:
  void catch_up(std::int64_t now_ns);
  void drop_time(std::int64_t behind_ns);
  void on_state(const joint_state_t& state);

  SimPort& port_;
  Simulator& simulator_;
  std::int64_t start_ns_ = 0;  ///< simulated time 0 on CLOCK_MONOTONIC
  std::int64_t session_ = 0;
  bool anchored_ = false;
  std::int64_t arm_offset_ns_ = 0;  ///< simulated time minus arm time
  LatencyHistogram lateness_;
  std::int64_t dropped_ns_ = 0;
  std::int64_t drops_ = 0;
};

}  // namespace limber::sim
