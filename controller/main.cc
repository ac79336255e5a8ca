// limber-controller: answers each JOINT_STATE with a JOINT_TORQUE, by the selected control law.
#include <spdlog/spdlog.h>

#include <cstdio>
#include <limits>

#include "common/program.h"
#include "common/run_id.h"
#include "controller/arm_controller.h"
#include "controller/controller_process.h"
#include "controller/laws/registry.h"
#include "controller/list_laws.h"
#include "robots/loader/load_robot.h"

namespace {

using namespace limber;

struct Arguments {
  std::string robot;
  std::string scenario;
  std::string law = ArmControllerOptions().law;
  std::optional<Pace> pace;
  std::int64_t controller = 0;
  int priority = 80;
  double duration_s = 0.0;
  bool list_laws = false;
  bool as_json = false;
};

void define(CommandLine& line, Arguments* given) {
  line.text("--robot", &given->robot,
            "shipped robot or folder with robot.yaml (default: the scenario's, else openarm)");
  line.text("--scenario", &given->scenario,
            "scenario file: names the robot, plays its timeline, lock step or not");
  line.text("--law", &given->law, "the law ACTIVE starts with");
  line.pace(&given->pace, "answer every state in order, without a clock");
  line.integer("--controller-id", &given->controller, 1, std::numeric_limits<std::int64_t>::max(),
               "names this run; default 1 in lock step, random in realtime");
  line.priority(&given->priority);
  line.number("--duration", &given->duration_s, 0.0, 1e8, "end after this many seconds; 0: never");
  line.flag("--list-laws", &given->list_laws, "print all control laws and exit");
  line.flag(
      "--json", &given->as_json,
      "with --list-laws: as JSON, with every gain; with --robot also what the arm cannot run");
}

int print_laws(const Arguments& given) {
  std::optional<LoadedRobot> robot;
  if (!given.robot.empty()) robot = load_robot(given.robot);
  const std::string list = given.as_json ? controller::list_laws_json(robot ? &*robot : nullptr)
                                         : controller::list_laws();
  std::fputs(list.c_str(), stdout);
  return kExitDone;
}

std::string robot_name(const Arguments& given) {
  if (!given.robot.empty()) return given.robot;
  return given.scenario.empty() ? "openarm" : scenario_robot(given.scenario);
}

ArmControllerOptions options_from(const Arguments& given, bool lockstep) {
  ArmControllerOptions options;
  options.law = given.law;
  options.controller = run_id(given.controller, lockstep);
  options.measure_time = !lockstep;
  return options;
}

int run(const Arguments& given) {
  controller::load_laws(scenario_laws(given.scenario));
  if (given.list_laws) return print_laws(given);
  const LoadedRobot robot = load_robot(robot_name(given));
  std::optional<Scenario> scenario;
  if (!given.scenario.empty())
    scenario = load_scenario(given.scenario, robot, &controller::law_catalog());
  const Pace wished = scenario && scenario->lockstep ? Pace::kLockstep : Pace::kRealtime;
  const Pace pace = given.pace.value_or(wished);
  const bool lockstep = in_lockstep(pace);
  ArmControllerOptions options = options_from(given, lockstep);
  options.allow_unstable = scenario && scenario->allow_unstable;
  ArmController controller(robot, options);
  if (scenario) controller.set_timeline(&scenario->timeline);
  ControllerProcess process(
      &controller, {pace, given.duration_s, given.priority, !robot.robot.on_virtual_buses(),
                    robot.robot.driven_names(), robot.robot.name, robot.robot.rate_hz});
  const auto& stop = stop_on_signals();
  spdlog::info("{}: {} joints, law {}, {}, controller {}", robot.robot.name, robot.robot.size(),
               options.law, lockstep ? "lock step" : "realtime", options.controller);
  process.run(stop);
  spdlog::info("ended after {} states", controller.status().states_received);
  return kExitDone;
}

}  // namespace

LIMBER_MAIN(controller) {
  CommandLine line("limber-controller",
                   "Answers each JOINT_STATE with a JOINT_TORQUE, by the selected control law.");
  Arguments given;
  define(line, &given);
  return run_program(line, argc, argv, [&] { return run(given); });
}
