// How late a 1 kHz cycle starts: the driver's own loop, which sleeps and then spins, or a plain
// clock_nanosleep() to the same deadlines. Prints one JSON line.
//
//   limber-bench-lateness [--seconds 2] [--plain]
#include <fmt/format.h>

#include "common/clock.h"
#include "common/latency_histogram.h"
#include "common/program.h"
#include "common/realtime.h"

using namespace limber;

namespace {

constexpr int kPriority = 90;  // as `cyclictest -p 90`
constexpr std::int64_t kPeriod_ns = 1'000'000;

int run(double seconds, bool plain) {
  const RealtimeGrant grant = ask_for_realtime(kPriority);
  PeriodicLoop loop(kPeriod_ns, plain ? 0 : PeriodicLoop::kSpin_ns);
  LatencyHistogram lateness;
  std::int64_t overruns = 0;
  const auto cycles = static_cast<std::int64_t>(seconds * 1e9) / kPeriod_ns;
  loop.start();
  for (std::int64_t i = 0; i < cycles; ++i) {
    const std::int64_t late_ns = loop.wait();
    lateness.add(late_ns);
    if (late_ns >= kPeriod_ns) ++overruns;
  }
  fmt::print(
      "{{\"cycles\": {}, \"fifo\": {}, \"p50_ns\": {}, \"p99_ns\": {}, \"max_ns\": {}, "
      "\"overruns\": {}}}\n",
      cycles, grant.fifo, lateness.quantile(0.5), lateness.quantile(0.99), lateness.max(),
      overruns);
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine line("limber-bench-lateness", "How late a 1 kHz cycle starts.");
  double seconds = 2.0;
  bool plain = false;
  line.number("--seconds", &seconds, 0.1, 1e5, "how long");
  line.flag("--plain", &plain, "clock_nanosleep() alone instead of the driver's loop");
  return run_program(line, argc, argv, [&] { return run(seconds, plain); });
}
