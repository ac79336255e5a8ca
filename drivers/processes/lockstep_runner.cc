#include "drivers/processes/lockstep_runner.h"

#include <spdlog/spdlog.h>

#include <cmath>

#include "common/clock.h"
#include "common/pace_text.h"
#include "common/realtime.h"
#include "lcmtypes/channels.h"

namespace limber {
namespace {

constexpr double kShutDownPatience_s = 1.0;
// A cycle's copies on the user plane are about 8 kB of a buffer of 416 kB (the kernel's default).
constexpr std::int64_t kReadersEvery = 10;
constexpr std::int64_t kMostBacklog_bytes = 100'000;
constexpr std::int64_t kReaderPause_ns = 500'000;
constexpr std::int64_t kReaderPatience_ns = 5'000'000'000;
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

void LockstepRunner::pace(const std::string& unraised) {
  pacer_.emplace(period_ns_);
  unraised_ = unraised;
}

bool LockstepRunner::run(const volatile std::sig_atomic_t& stop) {
  while (stop == 0 && !length_.reached(cycle_, static_cast<double>(cycle_ * period_ns_) * 1e-9)) {
    if (pacer_) {
      wait_until_due();
    } else if (cycle_ % kReadersEvery == 0) {
      wait_for_readers(stop);
    }
    const char* silent = cycle(stop);
    if (silent == nullptr) continue;
    if (stop != 0) break;
    spdlog::error("no {} for {:g} s (cycle {})", silent, patience_s_, cycle_);
    return false;
  }
  if (!pacer_) return true;
  report_pace();
  if (stop != 0) shut_down();
  return true;
}

// Whoever stops a run that he watches sees the drives brake and go off, as those of a real arm.
void LockstepRunner::shut_down() {
  constexpr std::sig_atomic_t kGoOn = 0;
  patience_s_ = kShutDownPatience_s;
  const std::int64_t end = cycle_ + std::llround(kShutDownPatience_s * 1e9) / period_ns_;
  port_->driver().request_shut_down();
  while (!port_->driver().shut_down() && cycle_ < end) {
    wait_until_due();
    if (cycle(kGoOn) != nullptr) break;
  }
  spdlog::info(port_->driver().shut_down() ? "every drive reports disabled"
                                           : "some drive does not report disabled");
}

void LockstepRunner::wait_until_due() {
  sleep_until(pacer_->next_due_ns(monotonic_ns()));
  const std::optional<double> share = pacer_->behind(monotonic_ns());
  if (!share || told_) return;
  told_ = true;
  spdlog::warn(
      "warning: {}: the three processes wait for one another's turn{}{}; nothing is lost. Close "
      "other programs, or use --one-process",
      pace_text(*share), unraised_.empty() ? "" : ", and ", unraised_);
}

// Nothing that is to be recorded is lost, however busy the machine is.
void LockstepRunner::wait_for_readers(const volatile std::sig_atomic_t& stop) {
  if (!readers_.watches_any() || told_) return;
  const std::int64_t end_ns = monotonic_ns() + kReaderPatience_ns;
  while (stop == 0 && readers_.bytes() > kMostBacklog_bytes) {
    const std::int64_t now_ns = monotonic_ns();
    if (now_ns > end_ns) {
      told_ = true;
      spdlog::warn(
          "warning: the recorder has read nothing for {:g} s: not waited for any longer, messages "
          "will be lost",
          1e-9 * static_cast<double>(kReaderPatience_ns));
      return;
    }
    sleep_until(now_ns + kReaderPause_ns);
  }
}

void LockstepRunner::report_pace() const {
  const double share = pacer_->share(monotonic_ns());
  const std::string text = length_text(1e-9 * static_cast<double>(cycle_ * period_ns_), share);
  share < Pacer::kBehind ? spdlog::warn("warning: {}; --one-process waits for no handovers", text)
                         : spdlog::info("{}", text);
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
