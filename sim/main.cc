// limber-sim: the simulated arm on its CAN buses, as the real one would be.
#include <spdlog/spdlog.h>

#include <string>
#include <vector>

#include "common/config_error.h"
#include "common/program.h"
#include "robots/loader/choose_buses.h"
#include "sim/sim_process.h"

using namespace limber;

namespace {

struct Arguments {
  std::string robot;
  std::string scenario;
  std::map<std::string, std::string> buses;
  std::optional<Pace> pace;
  std::string integrator;
  double step_s = 0.0;
  bool no_friction = false;
  bool no_stand = false;
  double duration_s = 0.0;
  std::vector<double> start_q;
  double rate_hz = 0.0;
  int priority = 60;
};

void define(CommandLine& line, Arguments* given) {
  line.text("--robot", &given->robot, "name or folder of the robot (default: the scenario's)");
  line.text("--scenario", &given->scenario,
            "scenario file: integrator, friction, start, lock step, and what happens when");
  line.buses(&given->buses);
  line.pace(&given->pace, "advance by the driver's TICKs");
  line.text("--integrator", &given->integrator, "ode or reference (default: ode)")
      .one_of({"ode", "reference"});
  line.number("--step", &given->step_s, 1e-6, 0.01,
              "longest integration step, s (default: 0.00025)");
  line.number("--rate", &given->rate_hz, 10.0, 20000.0,
              "control periods per second instead of robot.yaml's; as the driver's");
  line.flag("--no-friction", &given->no_friction, "joints without friction");
  line.flag("--no-stand", &given->no_stand, "nothing carries the arm before its drives do");
  line.number("--duration", &given->duration_s, 0.0, 1e6, "end after this much simulated time, s");
  line.numbers("--start-q", &given->start_q, "start position of each joint (default: home)");
  line.priority(&given->priority);
}

SimProcessOptions options_from(const Arguments& given, const Scenario& scenario) {
  const Pace wished = scenario.lockstep ? Pace::kLockstep : Pace::kRealtime;
  SimProcessOptions options{simulator_options(scenario), given.pace.value_or(wished),
                            given.duration_s, given.priority};
  SimulatorOptions& simulator = options.simulator;
  simulator.lockstep = in_lockstep(options.pace);
  if (given.integrator == "ode") simulator.integrator = Integrator::kOde;
  if (given.integrator == "reference") simulator.integrator = Integrator::kReference;
  if (given.step_s != 0.0) simulator.step_s = given.step_s;
  if (given.no_friction) simulator.friction = false;
  if (given.no_stand) simulator.stand = false;
  if (!given.start_q.empty()) simulator.start_q = given.start_q;
  return options;
}

int run(const Arguments& given) {
  if (given.robot.empty() && given.scenario.empty())
    throw ConfigError("--robot or --scenario is needed");
  LoadedRobot robot =
      load_robot(given.robot.empty() ? scenario_robot(given.scenario) : given.robot);
  Scenario scenario;
  scenario.lockstep = false;
  if (!given.scenario.empty()) scenario = load_scenario(given.scenario, robot, nullptr);
  choose_buses(given.buses, &robot.robot);
  require_simulated_buses(given.buses, robot.robot);
  if (given.rate_hz > 0.0) robot.robot.rate_hz = given.rate_hz;
  const SimProcessOptions options = options_from(given, scenario);
  const WireOptions& wire = scenario.wire;
  if (!options.simulator.lockstep && (wire.loss > 0 || wire.corruption > 0 || wire.delay_s > 0))
    spdlog::warn(
        "warning: {}: wire: acts in lock step; in real time frames arrive at once, and all",
        scenario.path);
  run_sim(robot, scenario.timeline, options, stop_on_signals());
  return kExitDone;
}

}  // namespace

LIMBER_MAIN(sim) {
  CommandLine line(
      "limber-sim",
      "The simulated arm on its CAN buses: motor nodes that answer as the real drives do.");
  Arguments given;
  define(line, &given);
  return run_program(line, argc, argv, [&] { return run(given); });
}
