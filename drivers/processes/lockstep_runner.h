// The driver's loop in lock step: a cycle ends when simulator and controller have answered.
#pragma once

#include <csignal>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "common/pacer.h"
#include "common/reader_backlog.h"
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

  /// From now on a run without a clock waits for these readers where their buffers fill.
  void wait_for(ReaderBacklog readers) { readers_ = std::move(readers); }

  /// Cycles until the end or until `stop` is set; then the time of the simulated arm stands still.
  /// A paced run that is stopped switches the drives off before. False, and a message, if simulator
  /// or controller did not answer.
  bool run(const volatile std::sig_atomic_t& stop);

 private:
  /// One cycle; returns what did not come, for the message, or nullptr.
  const char* cycle(const volatile std::sig_atomic_t& stop);
  void wait_until_due();
  void wait_for_readers(const volatile std::sig_atomic_t& stop);
  void shut_down();
  void report_pace() const;

  ArmPort* port_;
  RunLength length_;
  std::int64_t period_ns_;
  double patience_s_;
  std::optional<Pacer> pacer_;
  ReaderBacklog readers_{{}};
  std::string unraised_;
  bool told_ = false;  ///< that it, or a reader, is behind
  std::int64_t cycle_ = 0;
};

}  // namespace limber
