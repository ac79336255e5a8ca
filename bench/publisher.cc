// Publishes numbered messages of the size of a small status on the user plane, at a rate. Prints
// how many it sent and in how many seconds.
//
//   limber-bench-publisher --rate 20000 --seconds 2
#include <fmt/format.h>

#include <array>
#include <lcm/lcm-cpp.hpp>

#include "common/clock.h"
#include "common/lcm_url.h"
#include "common/open_lcm.h"
#include "common/program.h"
#include "common/realtime.h"

using namespace limber;

namespace {

constexpr std::size_t kBytes = 304;
constexpr std::int64_t kBurst_ns = 500'000;  // what is due is sent so often: no timer is finer here

int run(double rate_hz, double seconds) {
  const auto lcm = open_lcm(user_plane_url());
  std::array<std::uint8_t, kBytes> message{};
  const auto total = static_cast<std::int64_t>(rate_hz * seconds);
  std::int64_t sent = 0;
  const std::int64_t start_ns = monotonic_ns();
  PeriodicLoop loop(kBurst_ns, 0);
  for (loop.start(); sent < total; loop.wait()) {
    const double elapsed_s = static_cast<double>(monotonic_ns() - start_ns) * 1e-9;
    const auto due = std::min(total, static_cast<std::int64_t>(elapsed_s * rate_hz) + 1);
    for (; sent < due; ++sent) {
      for (std::size_t i = 0; i < 8; ++i)  // as the field `seq`: behind the fingerprint, big-endian
        message[8 + i] = static_cast<std::uint8_t>(sent >> (56U - 8U * i));
      lcm->publish("BENCH", message.data(), static_cast<unsigned>(message.size()));
    }
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
