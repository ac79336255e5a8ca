#include "drivers/processes/realtime_runner.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "common/clock.h"
#include "common/pace_text.h"
#include "lcmtypes/channels.h"

namespace limber {
namespace {

constexpr std::int64_t kShutDownPatience_ns = 1'000'000'000;

}  // namespace

RealtimeRunner::RealtimeRunner(ArmPort* port, double rate_hz, const RunLength& length)
    : port_(port),
      length_(length),
      period_ns_(std::llround(1e9 / rate_hz)),
      loop_(period_ns_, PeriodicLoop::kSpin_ns),
      overruns_(std::llround(std::ceil(rate_hz))) {}

void RealtimeRunner::run(const volatile std::sig_atomic_t& stop) {
  first_ns_ = monotonic_ns();
  loop_.start();
  while (!finished(stop)) cycle();

  ArmDriver& driver = port_->driver();
  driver.request_shut_down();
  const std::int64_t end_ns = monotonic_ns() + kShutDownPatience_ns;
  while (!driver.shut_down() && monotonic_ns() < end_ns) cycle();
  spdlog::info(driver.shut_down() ? "every drive reports disabled"
                                  : "some drive does not report disabled: its own watchdog acts");
}

void RealtimeRunner::cycle() {
  const std::int64_t lateness_ns = loop_.wait();
  const std::int64_t start_ns = monotonic_ns();
  if (cycle_ == 0) first_ns_ = start_ns;
  started_ns_ = start_ns;
  note_start(lateness_ns);

  port_->read_commands();  // an answer that came during the sleep is still in time
  port_->driver().transmit(start_ns - first_ns_, start_ns);
  port_->wait_for_replies(start_ns + port_->driver().reply_window_ns());
  port_->publish_state(port_->driver().finish_cycle());
  note_end(lateness_ns);  // the wait for a controller that does not answer is no overrun
  port_->wait_for_answer(loop_.deadline_ns() - PeriodicLoop::kSpin_ns);
  if (++cycle_ % channels::kDriverStatusEvery == 0) port_->publish_status();
}

void RealtimeRunner::note_start(std::int64_t lateness_ns) {
  CycleTiming& timing = port_->timing();
  timing.lateness.add(lateness_ns);
  if (lateness_ns > period_ns_ / 10) ++timing.late_cycles;
  if (lateness_ns > std::max(kStall_ns, period_ns_)) port_->note_stall(lateness_ns);
}

void RealtimeRunner::note_end(std::int64_t lateness_ns) {
  const bool overrun = lateness_ns >= period_ns_ || monotonic_ns() > loop_.deadline_ns();
  longest_ns_ = overrun ? std::max(longest_ns_, monotonic_ns() - started_ns_ + lateness_ns) : 0;
  if (overruns_.too_many(overrun)) port_->driver().report_overruns(longest_ns_);
  port_->timing().overrun_cycles = overruns_.count();
}

bool RealtimeRunner::finished(const volatile std::sig_atomic_t& stop) const {
  return stop != 0 ||
         length_.reached(cycle_, static_cast<double>(monotonic_ns() - first_ns_) * 1e-9);
}

}  // namespace limber
