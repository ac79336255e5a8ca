// A lab that others can see and talk to: on the user plane it is what the three processes are.
#pragma once

#include <csignal>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "common/black_box/black_box.h"
#include "common/event_log.h"
#include "common/lcm_port.h"
#include "common/pacer.h"
#include "common/run_lock.h"
#include "controller/request_desk.h"
#include "lab/cycle_messages.h"
#include "lab/frame_log.h"
#include "lab/lab.h"
#include "lab/told.h"

namespace limber {

class LiveLab {
 public:
  /// Opens the user plane; no driver may run beside it. `log` gets what is published and what
  /// requests are taken, `frames` the buses; both may be null. All outlive this. `pace`: kPaced or
  /// kLockstep. Throws ConfigError.
  LiveLab(Lab* lab, const Robot& robot, EventLog* log, FrameLog* frames, Pace pace);

  /// Until `stop` is set or so many `cycles` are done; 0: for ever. Throws std::runtime_error when
  /// the disk refuses.
  void run(std::int64_t cycles, const volatile std::sig_atomic_t& stop);

 private:
  void cycle();
  void shut_down();
  void write(EventLog* log, std::string_view channel, std::span<const std::uint8_t> data);
  void wait_until_due();
  void report_pace() const;

  Lab* lab_;
  FrameLog* frames_;
  RunLock lock_;
  std::unique_ptr<BlackBox> black_box_;
  LcmPort user_;
  RequestDesk desk_;
  CycleMessages messages_;
  Told told_;
  std::optional<Pacer> pacer_;
  bool told_behind_ = false;
  std::string failure_;  ///< of the log
};

}  // namespace limber
