// Publishes numbered messages of the size of a small status on the user plane, at a rate. Prints
// how many it sent and in how many seconds.
//
//   limber-bench-publisher --rate 20000 --seconds 2
#include <fmt/format.h>

#include <algorithm>

#include "common/clock.h"
#include "common/lcm_port.h"
#include "common/lcm_url.h"
#include "common/program.h"
#include "common/realtime.h"

using namespace limber;

namespace {

/// 304 bytes: its number as the field `seq`, behind where a fingerprint is, big-endian; zeros.
struct Numbered {
  std::int64_t seq = 0;

  int encode(void* out, int offset, int room) const {
    constexpr int kBytes = 304;
    if (room < kBytes) return -1;
    auto* bytes = static_cast<std::uint8_t*>(out) + offset;
    std::fill_n(bytes, kBytes, std::uint8_t{0});
    for (int i = 0; i < 8; ++i) bytes[8 + i] = static_cast<std::uint8_t>(seq >> (56 - 8 * i));
    return kBytes;
  }
};

constexpr std::int64_t kBurst_ns = 500'000;  // what is due is sent so often: no timer is finer here

int run(double rate_hz, double seconds) {
  LcmPort port(user_plane_url(), LcmPort::Use::kPublishOnly);
  const auto total = static_cast<std::int64_t>(rate_hz * seconds);
  std::int64_t sent = 0;
  const std::int64_t start_ns = monotonic_ns();
  PeriodicLoop loop(kBurst_ns, 0);
  for (loop.start(); sent < total; loop.wait()) {
    const double elapsed_s = static_cast<double>(monotonic_ns() - start_ns) * 1e-9;
    const auto due = std::min(total, static_cast<std::int64_t>(elapsed_s * rate_hz) + 1);
    for (; sent < due; ++sent) port.publish("BENCH", Numbered{sent});
  }
  fmt::print("{{\"sent\": {}, \"seconds\": {:.3f}}}\n", sent,
             static_cast<double>(monotonic_ns() - start_ns) * 1e-9);
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine line("limber-bench-publisher", "Numbered messages on the user plane, at a rate.");
  double rate_hz = 0.0;
  double seconds = 2.0;
  line.number("--rate", &rate_hz, 1.0, 1e7, "messages a second").required();
  line.number("--seconds", &seconds, 0.01, 1e5, "how long");
  return run_program(line, argc, argv, [&] { return run(rate_hz, seconds); });
}
