#include "common/pace_text.h"

#include <fmt/format.h>

#include <cstdlib>
#include <thread>

namespace limber {
namespace {

std::string load_text() {
  double load = 0.0;
  const unsigned processors = std::thread::hardware_concurrency();
  if (getloadavg(&load, 1) != 1) return fmt::format("{} processors", processors);
  return fmt::format("load average {:.1f} on {} processors", load, processors);
}

}  // namespace

std::string stall_text(const std::string& program, std::int64_t time_ns) {
  return fmt::format("{} stood still for {:.0f} ms: this machine was busy elsewhere ({})", program,
                     1e-6 * static_cast<double>(time_ns), load_text());
}

std::string pace_text(double share) {
  return fmt::format("simulated time runs at {:.0f} % of real time ({})", 100.0 * share,
                     load_text());
}

std::string length_text(double arm_time_s, double share) {
  return fmt::format("{:.1f} s of arm time took {:.1f} s, {:.0f} % of real time ({})", arm_time_s,
                     arm_time_s / share, 100.0 * share, load_text());
}

}  // namespace limber
