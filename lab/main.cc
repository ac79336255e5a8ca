// limber-lab: runs a scenario in one process, in lock step, and leaves the same log the three
// processes leave.
#include <spdlog/spdlog.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>

#include "common/clock.h"
#include "common/config_error.h"
#include "common/program.h"
#include "common/realtime.h"
#include "controller/laws/registry.h"
#include "lab/cycle_messages.h"
#include "lab/frame_log.h"
#include "lab/lab.h"
#include "lab/live_lab.h"
#include "lab/log_writer.h"
#include "lab/told.h"

using namespace limber;

namespace {

constexpr std::int64_t kProgressEvery_ns = 200'000'000;

struct Arguments {
  std::string scenario;
  std::string robot;
  std::string log;
  std::string can;
  bool progress = false;
  bool live = false;
  bool paced = false;
  double rate_hz = 0.0;
  std::int64_t cycles = 0;
};

/// To the terminal, on one line.
class Progress {
 public:
  Progress(bool shown, double duration_s) : shown_(shown), duration_s_(duration_s) {}

  void show(const Lab& lab) {
    if (!shown_ || lab.cycles() % 100 != 0 || monotonic_ns() - told_ns_ < kProgressEvery_ns) return;
    told_ns_ = monotonic_ns();
    std::fprintf(stderr, "\r%6.2f of %.2f s", static_cast<double>(lab.time_ns()) * 1e-9,
                 duration_s_);
  }
  void end() const {
    const double wall_s = static_cast<double>(monotonic_ns() - start_ns_) * 1e-9;
    std::fprintf(stderr, "%s%.2f s of arm time in %.2f s: %.1f times real time\n",
                 shown_ ? "\r" : "", duration_s_, wall_s, duration_s_ / wall_s);
  }

 private:
  bool shown_;
  double duration_s_;
  std::int64_t start_ns_ = monotonic_ns();
  std::int64_t told_ns_ = start_ns_;
};

int run_alone(const Arguments& given, const Robot& robot, const Scenario& scenario, Lab* lab) {
  Told told(robot);
  CycleMessages messages;
  std::unique_ptr<LogWriter> log;
  if (!given.log.empty()) log = std::make_unique<LogWriter>(given.log);
  std::unique_ptr<FrameLog> frames;
  if (!given.can.empty()) frames = std::make_unique<FrameLog>(given.can, robot, lab);
  const auto keep = [&](const char* channel, const auto& message) {
    log->write(lab->state().time_ns, channel, message);
  };

  Progress progress(given.progress, scenario.duration_s);
  const auto end_ns = static_cast<std::int64_t>(scenario.duration_s * 1e9);
  while (given.cycles > 0 ? lab->cycles() < given.cycles : lab->time_ns() < end_ns) {
    lab->step();
    told.note(*lab);
    if (log) messages.of_cycle(*lab, keep);
    if (frames) frames->write_cycle(lab->state().time_ns);
    progress.show(*lab);
  }
  if (log) {
    messages.of_end(*lab, keep);
    log->close();
  }
  if (frames) frames->flush();
  progress.end();
  return kExitDone;
}

int run_live(const Arguments& given, const Robot& robot, const Scenario& scenario, Lab* lab) {
  if (!robot.on_virtual_buses())
    throw ConfigError(robot.name + ": its buses are real; one process runs simulated arms only");
  const auto& stop = stop_on_signals();
  std::unique_ptr<EventLog> log;
  if (!given.log.empty()) log = std::make_unique<EventLog>(given.log);
  std::unique_ptr<FrameLog> frames;
  if (!given.can.empty()) frames = std::make_unique<FrameLog>(given.can, robot, lab);
  const Pace pace = given.paced ? Pace::kPaced : Pace::kLockstep;
  LiveLab live(lab, robot, log.get(), frames.get(), pace);
  raise_priority(given.paced);
  spdlog::info("{}, {} joints, {:g} Hz in lock step, driver, controller and simulator in one; {}",
               robot.name, robot.size(), robot.rate_hz,
               given.paced ? "not faster than the clock" : "no clock");
  const auto length = static_cast<std::int64_t>(std::llround(scenario.duration_s * robot.rate_hz));
  live.run(given.cycles > 0 ? given.cycles : length, stop);
  if (log) log->close();
  if (frames) frames->flush();
  return kExitDone;
}

int run(const Arguments& given) {
  controller::load_laws(scenario_laws(given.scenario));
  LoadedRobot robot =
      load_robot(given.robot.empty() ? scenario_robot(given.scenario) : given.robot);
  const Scenario scenario = load_scenario(given.scenario, robot, &controller::law_catalog());
  if (given.rate_hz > 0.0) robot.robot.rate_hz = given.rate_hz;
  Lab lab(robot, scenario);
  return given.live ? run_live(given, robot.robot, scenario, &lab)
                    : run_alone(given, robot.robot, scenario, &lab);
}

}  // namespace

LIMBER_MAIN(lab) {
  CommandLine line(
      "limber-lab",
      "Runs a scenario in one process, in lock step, as fast as the processor allows.");
  Arguments given;
  line.text("scenario", &given.scenario, "scenario file").required();
  line.text("--robot", &given.robot, "name or folder of the robot (default: the scenario's)");
  line.text("--log", &given.log, "LCM event log to write; compressed if it ends in .zst");
  line.text("--can", &given.can, "CAN frames to write, in candump's log format, in arm time");
  line.flag("--progress", &given.progress, "show how far it is");
  const Option live =
      line.flag("--live", &given.live,
                "publish all messages and take requests, as driver, controller and simulator do");
  line.flag("--paced", &given.paced, "not faster than the clock").needs(live);
  line.number("--rate", &given.rate_hz, 1.0, 20000.0, "cycles per second instead of robot.yaml's");
  line.integer("--cycles", &given.cycles, 1, std::numeric_limits<std::int64_t>::max(),
               "end after so many cycles instead of the scenario's duration");
  return run_program(line, argc, argv, [&] { return run(given); });
}
