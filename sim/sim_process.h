// limber-sim without its command line: the simulated arm, run by the driver's TICKs or by the
// clock.
#pragma once

#include <csignal>
#include <vector>

#include "common/pace.h"
#include "sim/simulator.h"

namespace limber {

struct SimProcessOptions {
  SimulatorOptions simulator;
  Pace pace = Pace::kRealtime;
  double duration_s = 0.0;  ///< simulated time after which to end; 0: until stopped
  int priority = 0;         ///< SCHED_FIFO priority to request in realtime; 0: none at all
};

/// Runs until `stop` is set or the duration is over. `timeline` may be empty. Throws ConfigError.
void run_sim(const LoadedRobot& robot, const std::vector<TimedMessage>& timeline,
             const SimProcessOptions& options, const volatile std::sig_atomic_t& stop);

}  // namespace limber
