#include "sim/sim_process.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "common/clock.h"
#include "common/realtime.h"
#include "sim/processes/realtime_runner.h"
#include "sim/processes/sim_port.h"

namespace limber {
namespace {

/// How long a stop request may go unnoticed.
constexpr std::int64_t kPatience_ns = 100'000'000;

std::string schedule(const SimProcessOptions& options) {
  const int priority = options.priority;
  if (in_lockstep(options.pace)) {
    if (priority != 0) raise_priority(options.pace == Pace::kPaced);
    return "lock step";
  }
  if (priority == 0) return "realtime, normal scheduling";
  const RealtimeGrant grant = ask_for_realtime(priority);
  std::string out =
      grant.fifo ? fmt::format("realtime, SCHED_FIFO {}", priority) : "realtime, normal scheduling";
  out += grant.locked_memory ? ", locked memory" : "";
  return grant.reason.empty() ? out : fmt::format("{} ({})", out, grant.reason);
}

void run_lockstep(sim::SimPort* port, std::int64_t end_ns, const volatile std::sig_atomic_t& stop) {
  Simulator& simulator = port->simulator();
  const auto over = [&] { return simulator.sim_time_ns() >= end_ns; };
  while (stop == 0 && !over()) {
    port->wait(monotonic_ns() + kPatience_ns);
    port->handle_messages();
    while (!over() && simulator.poll()) port->publish_truth();
  }
}

void report(const Simulator& simulator) {
  spdlog::info("ended at {:.3f} s of simulated time",
               static_cast<double>(simulator.sim_time_ns()) * 1e-9);
  if (simulator.refused() > 0)
    spdlog::warn("{} messages of the timeline were refused", simulator.refused());
  if (simulator.diverged() > 0)
    spdlog::warn("{} steps would have diverged; the arm was stopped instead", simulator.diverged());
}

}  // namespace

void run_sim(const LoadedRobot& robot, const std::vector<TimedMessage>& timeline,
             const SimProcessOptions& options, const volatile std::sig_atomic_t& stop) {
  const auto black_box =
      open_black_box("sim-" + robot.robot.name, robot.robot.rate_hz, options.pace);
  const std::string scheduling = schedule(options);
  sim::SimPort port(robot, &timeline, options.simulator);
  port.set_black_box(black_box.get());
  std::vector<std::string> buses;
  for (const BusConfig& bus : robot.robot.buses) buses.push_back(bus_text(bus.can));
  spdlog::info("{} on {}, {} at {:g} us, {}", robot.robot.name, fmt::join(buses, ", "),
               options.simulator.integrator == Integrator::kOde ? "ode" : "reference",
               1e6 * options.simulator.step_s, scheduling);
  const std::int64_t end_ns = options.duration_s > 0.0 ? std::llround(options.duration_s * 1e9)
                                                       : std::numeric_limits<std::int64_t>::max();
  if (options.simulator.lockstep) {
    run_lockstep(&port, end_ns, stop);
  } else {
    sim::RealtimeRunner runner(&port);
    runner.run(end_ns, stop);
    runner.report();
  }
  report(port.simulator());
}

}  // namespace limber
