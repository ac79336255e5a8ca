// Simulator, driver and controller, the real processes in lock step without a log: time per cycle,
// beside a bare UDP unicast ping-pong of the messages' sizes between two processes. The two take
// turns: the driver is stopped while the ping-pong runs. LIMBER_ARM_URL and
// LIMBER_VIRTUAL_BUS choose what carries messages and frames. Prints one JSON line; the figure that
// travels between machines is the ratio.
//
//   limber-bench-whole-loop --bin build/release/bin --scenario FILE [--turns 20]
#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <limber/controller_status_t.hpp>
#include <limber/driver_status_t.hpp>
#include <limber/joint_command_t.hpp>
#include <limber/joint_state_t.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/clock.h"
#include "common/lcm_port.h"
#include "common/program.h"
#include "common/realtime.h"
#include "lcmtypes/channels.h"
#include "qa/bench/udp_ping.h"
#include "scenarios/loader/scenario.h"

using namespace limber;

namespace {

constexpr std::int64_t kPatience_ns = 30'000'000'000;

class Stack {
 public:
  Stack(const std::string& bin, const std::string& scenario) {
    start({bin + "/limber-sim", "--lockstep", "--scenario", scenario});
    start({bin + "/limber-controller", "--lockstep", "--scenario", scenario});
    driver_ = start({bin + "/limber-driver", "--lockstep", "--robot", scenario_robot(scenario)});
  }
  Stack(const Stack&) = delete;
  Stack& operator=(const Stack&) = delete;
  ~Stack() {
    for (const pid_t process : processes_) {
      kill(process, SIGCONT);
      kill(process, SIGTERM);
    }
    for (const pid_t process : processes_) waitpid(process, nullptr, 0);
  }
  void pause() const { kill(driver_, SIGSTOP); }
  void resume() const { kill(driver_, SIGCONT); }

 private:
  pid_t start(std::vector<std::string> words) {
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    processes_.push_back(spawn([&] { execv(arguments[0], arguments.data()); }));
    return processes_.back();
  }
  std::vector<pid_t> processes_;
  pid_t driver_ = -1;
};

/// The driver tells of itself every kDriverStatusEvery cycles; what lies between two is timed.
class CycleTimes {
 public:
  CycleTimes() : user_(user_plane_url()) {
    user_.subscribe<driver_status_t>(channels::kDriverStatus, 4,
                                     [this](const driver_status_t& status) { note(status); });
  }
  /// Takes `count` more; the first after a pause counts for nothing.
  void take(int count) {
    wanted_ = count;
    last_ns_ = 0;
    const std::int64_t end_ns = monotonic_ns() + kPatience_ns;
    while (wanted_ > 0) {
      if (monotonic_ns() > end_ns) throw std::runtime_error("the loop does not run");
      if (wait_readable(user_.descriptor(), end_ns)) user_.handle_waiting();
    }
  }
  double median() { return median_of(&ns_per_cycle_); }

  static double median_of(std::vector<double>* values) {
    std::ranges::nth_element(*values, values->begin() + static_cast<long>(values->size() / 2));
    return (*values)[values->size() / 2];
  }

 private:
  void note(const driver_status_t& status) {
    const std::int64_t now_ns = monotonic_ns();
    if (last_ns_ != 0 && --wanted_ >= 0)
      ns_per_cycle_.push_back(static_cast<double>(now_ns - last_ns_) /
                              static_cast<double>(status.cycles - last_cycles_));
    last_ns_ = now_ns;
    last_cycles_ = status.cycles;
  }

  LcmPort user_;
  int wanted_ = 0;
  std::int64_t last_ns_ = 0;
  std::int64_t last_cycles_ = 0;
  std::vector<double> ns_per_cycle_;
};

int run(const std::string& bin, const std::string& scenario, std::int64_t turns) {
  constexpr int kWarmUp = 20;
  constexpr int kStatuses = 10;
  constexpr int kPings = 1000;
  // The programs, which ask for none in lock step, inherit it: what else runs here counts for
  // little.
  const RealtimeGrant grant = ask_for_realtime(bench::kPriority);
  bench::UdpPing udp(static_cast<std::size_t>(joint_state_t().getEncodedSize()),
                     static_cast<std::size_t>(joint_command_t().getEncodedSize()), true);
  std::vector<double> pings;
  CycleTimes warm_up;
  CycleTimes cycles;
  const Stack stack(bin, scenario);
  warm_up.take(kWarmUp);
  for (std::int64_t turn = 0; turn < turns; ++turn) {
    cycles.take(kStatuses);
    stack.pause();
    for (int i = 0; i < kPings; ++i) pings.push_back(static_cast<double>(udp.round()));
    stack.resume();
  }
  const double cycle_us = 1e-3 * cycles.median();
  const double udp_us = 1e-3 * CycleTimes::median_of(&pings);
  fmt::print(
      "{{\"arm_plane\": \"{}\", \"fifo\": {}, \"turns\": {}, \"cycle_us\": {:.1f}, \"udp_us\": "
      "{:.1f}, "
      "\"ratio\": {:.2f}}}\n",
      arm_plane_url(), grant.fifo, turns, cycle_us, udp_us, cycle_us / udp_us);
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine line("limber-bench-whole-loop",
                   "Time per cycle of the three processes in lock step, beside UDP unicast.");
  std::string bin;
  std::string scenario;
  std::int64_t turns = 20;
  line.text("--bin", &bin, "folder of the programs to measure").required();
  line.text("--scenario", &scenario, "what they do").required();
  line.integer("--turns", &turns, 1, 10'000, "turns of 1000 cycles and 1000 round trips");
  return run_program(line, argc, argv, [&] { return run(bin, scenario, turns); });
}
