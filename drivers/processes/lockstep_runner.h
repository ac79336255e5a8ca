// The driver's loop in lock step: a cycle ends when simulator and controller have answered.
#pragma once

#include <csignal>
#include <cstdint>
#include <optional>
#include <string>

#include "common/pacer.h"
#include "drivers/processes/arm_port.h"
#include "drivers/processes/run_length.h"

namespace limber {

class LockstepRunner {
 public:
  /// `port` outlives this. `patience_s`: longest silence of simulator or controller.
  LockstepRunner(ArmPort* port, double rate_hz, double patience_s, const RunLength& length);

  /// From now on a cycle begins no sooner than the clock allows. `unraised`: why the process could
  /// not raise its priority, "" if it could; for the message of a run that falls behind.
  void pace(const std::string& unraised);

  /// Cycles until the end or until `stop` is set; then the time of the simulated arm stands still.
  /// A paced run that is stopped switches the drives off before. False, and a message, if simulator
  /// or controller did not answer.
  bool run(const volatile std::sig_atomic_t& stop);

 private:
  /// One cycle; returns what did not come, for the message, or nullptr.
  const char* cycle(const volatile std::sig_atomic_t& stop);
  void wait_until_due();
  void shut_down();
  void report_pace() const;

  ArmPort* port_;
  RunLength length_;
  std::int64_t period_ns_;
  double patience_s_;
  std::optional<Pacer> pacer_;
  std::string unraised_;
  bool told_ = false;  ///< that it is behind
  std::int64_t cycle_ = 0;
};

}  // namespace limber
