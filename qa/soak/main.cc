// limber-soak: hours of arm time in lock step, with random use and injected faults.
#include <cstdio>
#include <string>

#include "common/clock.h"
#include "common/program.h"
#include "qa/soak/soak.h"
#include "qa/soak/soak_report.h"

using namespace limber;

namespace {

struct Arguments {
  std::string robot = "planar2r";
  double arm_hours = 24.0;
  double most_s = 0.0;
  std::int64_t seed = 1;
  bool any_request = false;
  bool progress = false;
};

int run(const Arguments& given) {
  const auto& stop = stop_on_signals();
  const LoadedRobot robot = load_robot(given.robot);
  soak::Soak soak(robot, static_cast<std::uint64_t>(given.seed),
                  given.any_request ? soak::Habit::kAnything : soak::Habit::kCareful);
  const std::int64_t start_ns = monotonic_ns();
  const auto wall_s = [&] { return 1e-9 * static_cast<double>(monotonic_ns() - start_ns); };
  double told_s = 0.0;
  const soak::SoakResult& result = soak.run(3600.0 * given.arm_hours, [&] {
    if (given.progress && wall_s() - told_s > 1.0) {
      told_s = wall_s();
      std::fprintf(stderr, "\r%8.3f of %g h of arm time, %lld recoveries", soak.time_s() / 3600.0,
                   given.arm_hours, static_cast<long long>(soak.result().recoveries));
    }
    return stop == 0 && (given.most_s == 0.0 || wall_s() < given.most_s);
  });
  if (given.progress) std::fputc('\n', stderr);
  const auto seed = static_cast<std::uint64_t>(given.seed);
  std::fputs(soak::report_json(result, robot.robot, seed, wall_s()).c_str(), stdout);
  return result.violations.empty() ? kExitDone : 1;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine line("limber-soak",
                   "Random use of a simulated arm for hours of arm time, with injected faults. "
                   "Prints JSON. Exit status 1: something happened that must not.");
  Arguments given;
  line.text("--robot", &given.robot, "name of a shipped robot, or a folder");
  line.number("--arm-hours", &given.arm_hours, 1e-4, 1e4, "how much arm time");
  line.number("--most-seconds", &given.most_s, 0.0, 1e7, "stop after so much wall time (0: never)");
  line.integer("--seed", &given.seed, 0, 1'000'000'000, "of everything random");
  line.flag("--any-request", &given.any_request,
            "any law, gain and goal at random, as fast as may be, instead of careful use");
  line.flag("--progress", &given.progress, "show how far it is");
  return run_program(line, argc, argv, [&] { return run(given); });
}
