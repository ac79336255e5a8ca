// The driver's loop against the clock: absolute deadlines, one cycle a period.
#pragma once

#include <csignal>
#include <cstdint>

#include "common/realtime.h"
#include "drivers/processes/arm_port.h"
#include "drivers/processes/overrun_watch.h"
#include "drivers/processes/run_length.h"

namespace limber {

class RealtimeRunner {
 public:
  /// `port` outlives this.
  RealtimeRunner(ArmPort* port, double rate_hz, const RunLength& length);

  /// Cycles until the end or until `stop` is set, then shuts the arm down: drives that are enabled
  /// brake for 0.3 s and are disabled.
  void run(const volatile std::sig_atomic_t& stop);

 private:
  void cycle();
  void note_start(std::int64_t lateness_ns);
  void note_end(std::int64_t lateness_ns);
  bool finished(const volatile std::sig_atomic_t& stop) const;

  ArmPort* port_;
  RunLength length_;
  std::int64_t period_ns_;
  PeriodicLoop loop_;
  OverrunWatch overruns_;
  std::int64_t cycle_ = 0;
  std::int64_t first_ns_ = 0;    ///< CLOCK_MONOTONIC at cycle 0
  std::int64_t started_ns_ = 0;  ///< at the present one
  std::int64_t longest_ns_ = 0;  ///< of the overruns in a row
};

}  // namespace limber
