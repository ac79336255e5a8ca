// The driver's loop without a clock: a cycle ends when simulator and controller have answered.
#pragma once

#include <csignal>
#include <cstdint>

#include "drivers/processes/arm_port.h"
#include "drivers/processes/run_length.h"

namespace limber {

class LockstepRunner {
 public:
  /// `port` outlives this. `patience_s`: longest silence of simulator or controller.
  LockstepRunner(ArmPort* port, double rate_hz, double patience_s, const RunLength& length);

  /// Cycles until the end or until `stop` is set; then the time of the simulated arm stands still.
  /// False, and a message, if simulator or controller did not answer.
  bool run(const volatile std::sig_atomic_t& stop);

 private:
  /// One cycle; returns what did not come, for the message, or nullptr.
  const char* cycle(const volatile std::sig_atomic_t& stop);

  ArmPort* port_;
  RunLength length_;
  std::int64_t period_ns_;
  double patience_s_;
  std::int64_t cycle_ = 0;
};

}  // namespace limber
