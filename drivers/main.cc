// limber-driver: owns the arm's buses and is its clock.
#include <limits>

#include "common/program.h"
#include "common/run_id.h"
#include "drivers/processes/driver_process.h"

namespace {

struct Arguments {
  limber::DriverProcessOptions options;
  std::optional<limber::Pace> pace;
};

void define(limber::CommandLine& line, Arguments* given) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  limber::DriverProcessOptions& options = given->options;
  line.text("--robot", &options.robot, "shipped robot or folder with robot.yaml");
  line.buses(&options.buses);
  line.number("--rate", &options.rate_hz, 10.0, 20000.0,
              "cycles per second instead of robot.yaml's");
  line.pace(&given->pace, "no clock: simulator and controller set the pace");
  line.integer("--session", &options.session, 1, kMost,
               "number of this run (default: random; lock step: 1)");
  line.number("--duration", &options.duration_s, 1e-3, 1e8, "stop after so much arm time, s");
  line.integer("--cycles", &options.cycles, 1, kMost, "stop after so many cycles");
  line.priority(&options.realtime_priority);
  line.integers("--wait-for", &options.readers,
                "processes that record: without a clock, the run waits where they fall behind");
  line.number("--patience", &options.patience_s, 0.0, 1e6,
              "give up (exit 3) when motors, simulator or controller are silent so long, s");
}

int run(Arguments given) {
  given.options.pace = given.pace.value_or(limber::Pace::kRealtime);
  given.options.session = limber::run_id(given.options.session, in_lockstep(given.options.pace));
  return limber::DriverProcess(given.options).run(limber::stop_on_signals());
}

}  // namespace

LIMBER_MAIN(driver) {
  limber::CommandLine line(
      "limber-driver",
      "Drives the motors of an arm: one frame to each and one reply from each a cycle, JOINT_STATE "
      "out, JOINT_TORQUE in.\nExit status: 0 done, 2 set-up wrong, 3 motors, simulator or "
      "controller silent.");
  Arguments given;
  define(line, &given);
  return limber::run_program(line, argc, argv, [&] { return run(given); });
}
