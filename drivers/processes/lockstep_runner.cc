#include "drivers/processes/lockstep_runner.h"

#include <spdlog/spdlog.h>

#include <cmath>

#include "common/clock.h"
#include "lcmtypes/channels.h"

namespace limber {
namespace {

constexpr std::int64_t kRepeat_ns = 100'000'000;  // then once more: a datagram may be lost

/// Waits until `arrived(deadline)`, calling `repeat` in between. False after `patience_s`, or when
/// `stop` is set.
template <typename Arrived, typename Repeat>
bool wait_patiently(double patience_s, const volatile std::sig_atomic_t& stop, Arrived arrived,
                    Repeat repeat) {
  const std::int64_t end_ns = monotonic_ns() + static_cast<std::int64_t>(patience_s * 1e9);
  while (!arrived(monotonic_ns() + kRepeat_ns)) {
    if (stop != 0 || monotonic_ns() > end_ns) return false;
    repeat();
  }
  return true;
}

}  // namespace

LockstepRunner::LockstepRunner(ArmPort* port, double rate_hz, double patience_s,
                               const RunLength& length)
    : port_(port),
      length_(length),
      period_ns_(std::llround(1e9 / rate_hz)),
      patience_s_(patience_s) {}

bool LockstepRunner::run(const volatile std::sig_atomic_t& stop) {
  while (stop == 0 && !length_.reached(cycle_, static_cast<double>(cycle_ * period_ns_) * 1e-9)) {
    const char* silent = cycle(stop);
    if (silent == nullptr) continue;
    if (stop != 0) break;
    spdlog::error("no {} for {:g} s (cycle {})", silent, patience_s_, cycle_);
    return false;
  }
  return true;
}

const char* LockstepRunner::cycle(const volatile std::sig_atomic_t& stop) {
  ArmDriver& driver = port_->driver();
  driver.transmit(cycle_ * period_ns_, cycle_ * period_ns_);
  if (!wait_patiently(
          patience_s_, stop, [&](std::int64_t end_ns) { return port_->wait_for_replies(end_ns); },
          [&] { driver.repeat_tick(); }))
    return "TOCK from the simulator";
  port_->publish_state(driver.finish_cycle());
  if (!wait_patiently(
          patience_s_, stop, [&](std::int64_t end_ns) { return port_->wait_for_answer(end_ns); },
          [&] { port_->repeat_state(); }))
    return "answer from the controller";
  if (++cycle_ % channels::kDriverStatusEvery == 0) port_->publish_status();
  return nullptr;
}

}  // namespace limber
