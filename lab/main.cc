// limber-lab: runs a scenario in one process, in lock step, and leaves the same log the three
// processes leave.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <memory>

#include "common/clock.h"
#include "common/config_error.h"
#include "lab/lab.h"
#include "lab/log_writer.h"
#include "lcmtypes/channels.h"

namespace {

using namespace limber;

void log_cycle(Lab& lab, LogWriter& log) {
  const std::int64_t time_ns = lab.state().time_ns;
  const std::int64_t seq = lab.state().seq;
  log.write(time_ns, channels::kJointState, lab.state());
  log.write(time_ns, channels::kSimTruth, lab.truth());
  log.write(time_ns, channels::kJointTorque, lab.torque());
  if (seq % channels::kControllerStatusEvery == 0) {
    log.write(time_ns, channels::kControllerStatus, lab.controller_status());
  }
  if (seq % channels::kDriverStatusEvery == 0)
    log.write(time_ns, channels::kDriverStatus, lab.driver_status());
}

void run(const std::string& path, const std::string& log_path, bool progress) {
  const LoadedRobot robot = load_robot(scenario_robot(path));
  const Scenario scenario = load_scenario(path, robot);
  Lab lab(robot, scenario);
  std::unique_ptr<LogWriter> log;
  if (!log_path.empty()) log = std::make_unique<LogWriter>(log_path);

  const auto end_ns = static_cast<std::int64_t>(scenario.duration_s * 1e9);
  const std::int64_t start_ns = monotonic_ns();
  std::int64_t told_ns = start_ns;
  while (lab.time_ns() < end_ns) {
    lab.step();
    if (log) log_cycle(lab, *log);
    if (progress && lab.cycles() % 100 == 0 && monotonic_ns() - told_ns > 200'000'000) {
      told_ns = monotonic_ns();
      std::fprintf(stderr, "\r%6.2f of %.2f s", static_cast<double>(lab.time_ns()) * 1e-9,
                   scenario.duration_s);
    }
  }
  if (log) log->write(lab.state().time_ns, channels::kDriverStatus, lab.driver_status());
  const double wall_s = static_cast<double>(monotonic_ns() - start_ns) * 1e-9;
  std::fprintf(stderr, "%s%.2f s of arm time in %.2f s: %.1f times real time\n",
               progress ? "\r" : "", scenario.duration_s, wall_s, scenario.duration_s / wall_s);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Runs a scenario in one process, in lock step, as fast as the processor allows."};
  std::string scenario;
  std::string log;
  bool progress = false;
  app.add_option("scenario", scenario, "scenario file")->required();
  app.add_option("--log", log, "LCM event log to write");
  app.add_flag("--progress", progress, "show how far it is");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    run(scenario, log, progress);
  } catch (const limber::ConfigError& error) {
    std::fprintf(stderr, "limber-lab: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "limber-lab: %s\n", error.what());
    return 3;
  }
  return 0;
}
