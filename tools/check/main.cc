// limber-check: reads a robot, a URDF or a scenario as the other programs would, and says what it
// found, or everything that is wrong with it.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "common/config_error.h"
#include "common/parse_number.h"
#include "common/suggest.h"
#include "controller/arm_controller.h"
#include "tools/check/print.h"

namespace {

using namespace limber;

struct Arguments {
  std::string robot;
  std::string urdf;
  std::string base;
  std::string tip;
  std::string gravity = "0,0,-9.81";
  std::string scenario;
  bool as_json = false;
};

std::vector<double> parse_gravity(const std::string& text) {
  std::vector<double> gravity;
  std::size_t start = 0;
  while (start <= text.size()) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    const auto value = parse_number(text.substr(start, end - start));
    if (!value) break;
    gravity.push_back(*value);
    start = end + 1;
  }
  if (gravity.size() != 3 || start != text.size() + 1)
    throw ConfigError("--gravity: found '" + text + "'; expected three numbers x,y,z in m/s^2");
  return gravity;
}

std::string check_arm(const LoadedRobot& robot, bool as_json) {
  const ArmReport report = make_arm_report(robot);
  return as_json ? arm_json(robot, report) : arm_text(robot, report);
}

/// The controller would refuse an unknown law in the middle of the run.
void check_laws(const Scenario& scenario) {
  const std::vector<std::string> laws = law_names();
  for (const TimedMessage& timed : scenario.timeline) {
    const auto* gains = std::get_if<compliance_gains_t>(&timed.message);
    if (gains == nullptr || gains->law.empty()) continue;
    if (std::find(laws.begin(), laws.end(), gains->law) != laws.end()) continue;
    const std::string near = nearest_word(gains->law, laws);
    throw ConfigError::at(
        scenario.path, 0, "",
        fmt::format("gains at {} s: no law '{}'{}; there are: {}",
                    static_cast<double>(timed.time_ns) * 1e-9, gains->law,
                    near.empty() ? "" : "; did you mean '" + near + "'?", joined(laws)));
  }
}

std::string check(const CLI::App& app, const Arguments& arguments) {
  if (app.got_subcommand("robot")) return check_arm(load_robot(arguments.robot), arguments.as_json);
  if (app.got_subcommand("urdf")) {
    return check_arm(load_urdf(arguments.urdf, arguments.base, arguments.tip,
                               parse_gravity(arguments.gravity).data()),
                     arguments.as_json);
  }
  const LoadedRobot robot = load_robot(scenario_robot(arguments.scenario));
  const Scenario scenario = load_scenario(arguments.scenario, robot);
  check_laws(scenario);
  return arguments.as_json ? scenario_json(scenario, robot) : scenario_text(scenario, robot);
}

void add_options(CLI::App* app, Arguments* arguments) {
  app->require_subcommand(1);
  auto* robot = app->add_subcommand("robot", "a robot: robot.yaml with its URDF");
  robot->add_option("robot", arguments->robot, "name of a shipped robot, or a folder")->required();
  auto* urdf = app->add_subcommand("urdf", "a URDF by itself");
  urdf->add_option("file", arguments->urdf, "URDF file")->required();
  urdf->add_option("--base", arguments->base, "link the arm is fixed by")->required();
  urdf->add_option("--tip", arguments->tip, "link the arm works with")->required();
  urdf->add_option("--gravity", arguments->gravity,
                   "x,y,z in m/s^2, axes of the URDF's root link (default 0,0,-9.81)");
  auto* scenario = app->add_subcommand("scenario", "a scenario file, against its robot");
  scenario->add_option("file", arguments->scenario, "scenario file")->required();
  for (auto* command : {robot, urdf, scenario})
    command->add_flag("--json", arguments->as_json, "print one JSON object");
}

int run(int argc, char** argv) {
  CLI::App app{"Checks robots, URDFs and scenarios. Exit status 0: fine, 2: refused."};
  Arguments arguments;
  add_options(&app, &arguments);
  try {
    app.parse(argc, argv);
    std::fputs(check(app, arguments).c_str(), stdout);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const ConfigError& error) {
    if (arguments.as_json) std::fputs(refusal_json(error.what()).c_str(), stdout);
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "limber-check: %s\n", error.what());
    return 3;
  }
}
