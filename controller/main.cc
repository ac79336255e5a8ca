// limber-controller: answers each JOINT_STATE with a JOINT_TORQUE, by the selected control law.
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <exception>
#include <optional>
#include <random>

#include "common/config_error.h"
#include "controller/arm_controller.h"
#include "controller/controller_process.h"
#include "controller/laws/registry.h"

namespace {

using namespace limber;

// Longer than the 50 ms that the driver bridges on virtual buses: the driver decides first.
constexpr double kVirtualBridge_s = 0.06;

volatile bool stop = false;

extern "C" void on_signal(int /*signal*/) { stop = true; }

struct Arguments {
  std::string robot;
  std::string scenario;
  std::string law = ArmControllerOptions().law;
  std::optional<bool> lockstep;
  std::optional<std::int64_t> controller;
  int priority = 80;
  double duration_s = 0.0;
  bool list_laws = false;
};

void define(CLI::App& app, Arguments& given) {
  app.add_option("--robot", given.robot,
                 "shipped robot or folder with robot.yaml (default: the scenario's, else openarm)");
  app.add_option("--scenario", given.scenario,
                 "scenario file: names the robot, plays its timeline");
  app.add_option("--law", given.law, "the law ACTIVE starts with")->capture_default_str();
  app.add_flag("--lockstep,!--realtime", given.lockstep,
               "answer every state in order and look at no clock (default: as the scenario says, "
               "else realtime)");
  app.add_option("--controller-id", given.controller,
                 "names this run; default 1 in lock step, random in realtime")
      ->check(CLI::PositiveNumber);
  app.add_option("--realtime-priority", given.priority, "SCHED_FIFO priority; 0: do not ask")
      ->check(CLI::Range(0, 99))
      ->capture_default_str();
  app.add_option("--duration", given.duration_s, "end after this many seconds; 0: never")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--list-laws", given.list_laws, "print all control laws and exit");
}

void print_laws() {
  for (const auto& law : controller::laws()) std::printf("%-24s %s\n", law.name, law.summary);
}

std::int64_t random_id() {
  std::random_device device;
  return std::uniform_int_distribution<std::int64_t>(2)(device);
}

std::string robot_name(const Arguments& given) {
  if (!given.robot.empty()) return given.robot;
  return given.scenario.empty() ? "openarm" : scenario_robot(given.scenario);
}

void run(const Arguments& given) {
  const LoadedRobot robot = load_robot(robot_name(given));
  std::optional<Scenario> scenario;
  if (!given.scenario.empty()) scenario = load_scenario(given.scenario, robot);
  const bool lockstep = given.lockstep.value_or(scenario ? scenario->lockstep : false);

  ArmControllerOptions options;
  options.law = given.law;
  options.controller = given.controller.value_or(lockstep ? 1 : random_id());
  options.measure_time = !lockstep;
  if (!lockstep && robot.robot.on_virtual_buses()) {
    // The driver bridges hiccups of this machine's scheduler on a virtual bus; so does the
    // controller.
    options.bridged_cycles = static_cast<int>(kVirtualBridge_s * robot.robot.rate_hz);
  }
  ArmController controller(robot, options);
  if (scenario) controller.set_timeline(&scenario->timeline);
  ControllerProcess process(&controller, {lockstep, given.duration_s, given.priority});

  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  spdlog::info("{}: {} joints, law {}, {}, controller {}", robot.robot.name, robot.robot.size(),
               options.law, lockstep ? "lock step" : "realtime", options.controller);
  process.run(stop);
  spdlog::info("ended after {} states", controller.status().states_received);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Answers each JOINT_STATE with a JOINT_TORQUE, by the selected control law."};
  Arguments given;
  define(app, given);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (given.list_laws) {
    print_laws();
    return 0;
  }
  try {
    run(given);
  } catch (const limber::ConfigError& error) {
    std::fprintf(stderr, "limber-controller: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "limber-controller: %s\n", error.what());
    return 3;
  }
  return 0;
}
