// limber-sim: the simulated arm on its CAN buses, as the real one would be.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <exception>

#include "common/config_error.h"
#include "sim/sim_process.h"

namespace {

using limber::ConfigError;

std::atomic<bool> stop{false};

void on_signal(int) { stop = true; }

struct Arguments {
  std::string robot;
  std::string scenario;
  std::vector<std::string> buses;
  bool lockstep = false;
  bool realtime = false;
  std::string integrator;
  double step_s = 0.0;
  bool no_friction = false;
  bool no_stand = false;
  double duration_s = 0.0;
  std::vector<double> start_q;
  double rate_hz = 0.0;
  int priority = 60;
};

void declare(CLI::App& app, Arguments& a) {
  app.add_option("--robot", a.robot, "name or folder of the robot (default: the scenario's)");
  app.add_option("--scenario", a.scenario,
                 "scenario file: integrator, friction, start, and what happens when");
  app.add_option("--bus", a.buses,
                 "NAME=ADDRESS instead of the robot's own, such as arm=virtual:desk");
  auto* lockstep = app.add_flag("--lockstep", a.lockstep, "advance by the driver's TICKs");
  app.add_flag("--realtime", a.realtime, "advance by the clock, whatever the scenario says")
      ->excludes(lockstep);
  app.add_option("--integrator", a.integrator, "ode or reference (default: ode)")
      ->check(CLI::IsMember({"ode", "reference"}));
  app.add_option("--step", a.step_s, "longest integration step, s (default: 0.00025)");
  app.add_option("--rate", a.rate_hz,
                 "control periods per second instead of robot.yaml's; as the driver's")
      ->check(CLI::Range(1.0, 20000.0));
  app.add_flag("--no-friction", a.no_friction, "joints without friction");
  app.add_flag("--no-stand", a.no_stand, "nothing carries the arm before its drives do");
  app.add_option("--duration", a.duration_s, "end after this much simulated time, s");
  app.add_option("--start-q", a.start_q, "start position of each joint (default: home)")
      ->delimiter(',');
  app.add_option("--realtime-priority", a.priority,
                 "SCHED_FIFO priority to ask for in realtime; 0: do not ask (default: 60)")
      ->check(CLI::Range(0, 99));
}

/// Puts the simulator on the buses asked for. A robot.yaml that names a real interface is meant for
/// a real arm: the simulator goes there only when told so by name.
void choose_buses(const std::vector<std::string>& choices, limber::Robot* robot) {
  std::vector<bool> chosen(robot->buses.size(), false);
  for (const std::string& choice : choices) {
    const auto equals = choice.find('=');
    bool found = false;
    for (std::size_t i = 0; equals != std::string::npos && i < robot->buses.size(); ++i) {
      if (robot->buses[i].name != choice.substr(0, equals)) continue;
      robot->buses[i].can = choice.substr(equals + 1);
      chosen[i] = found = true;
    }
    if (!found)
      throw ConfigError("--bus " + choice + ": NAME=ADDRESS with a bus of the robot is needed");
  }
  for (std::size_t i = 0; i < robot->buses.size(); ++i) {
    const limber::BusConfig& bus = robot->buses[i];
    if (chosen[i] || bus.can.rfind("virtual:", 0) == 0) continue;
    throw ConfigError(fmt::format("bus {} is {}, which may carry a real arm; say --bus {}=ADDRESS",
                                  bus.name, bus.can, bus.name));
  }
}

limber::SimProcessOptions options_from(const Arguments& a, const limber::Scenario& scenario) {
  limber::SimProcessOptions options;
  options.simulator = limber::simulator_options(scenario);
  options.simulator.lockstep = a.lockstep || (!a.realtime && scenario.lockstep);
  if (!a.integrator.empty()) {
    options.simulator.integrator =
        a.integrator == "ode" ? limber::Integrator::kOde : limber::Integrator::kReference;
  }
  if (a.step_s != 0.0) options.simulator.step_s = a.step_s;
  if (a.no_friction) options.simulator.friction = false;
  if (a.no_stand) options.simulator.stand = false;
  if (!a.start_q.empty()) options.simulator.start_q = a.start_q;
  if (!(a.duration_s >= 0.0 && a.duration_s <= 1e6)) {
    throw ConfigError(fmt::format("--duration {}: 0 to 1e6 s are allowed", a.duration_s));
  }
  options.duration_s = a.duration_s;
  options.priority = a.priority;
  return options;
}

void run(const Arguments& a) {
  if (a.robot.empty() && a.scenario.empty()) throw ConfigError("--robot or --scenario is needed");
  limber::LoadedRobot robot =
      limber::load_robot(a.robot.empty() ? limber::scenario_robot(a.scenario) : a.robot);
  limber::Scenario scenario;
  scenario.lockstep = false;
  if (!a.scenario.empty()) scenario = limber::load_scenario(a.scenario, robot);
  choose_buses(a.buses, &robot.robot);
  if (a.rate_hz > 0.0) robot.robot.rate_hz = a.rate_hz;
  limber::SimProcess process(robot, &scenario.timeline, options_from(a, scenario));
  process.run(stop);
}

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;  // no SA_RESTART: a wait in progress returns
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "The simulated arm on its CAN buses: motor nodes that answer as the real drives do."};
  Arguments arguments;
  declare(app, arguments);
  catch_signals();
  try {
    app.parse(argc, argv);
    run(arguments);
  } catch (const CLI::Success& wish) {
    return app.exit(wish);
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "limber-sim: {}\n", error.what());
    return 2;
  } catch (const ConfigError& error) {
    fmt::print(stderr, "limber-sim: {}\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "limber-sim: {}\n", error.what());
    return 3;
  }
  return 0;
}
