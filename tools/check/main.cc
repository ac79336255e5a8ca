// limber-check: reads a robot, a URDF or a scenario as the other programs would, and says what it
// found, or everything that is wrong with it.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "common/config_error.h"
#include "common/parse_number.h"
#include "common/program.h"
#include "controller/laws/registry.h"
#include "drivers/bus_load.h"
#include "robots/loader/required_keys.h"
#include "tools/check/law_check.h"
#include "tools/check/print.h"
#include "tools/check/robot_json.h"

using namespace limber;

namespace {

struct Arguments {
  std::string robot;
  std::string urdf;
  std::string base;
  std::string tip;
  std::string gravity = "0,0,-9.81";
  std::string scenario;
  std::string law_file;
  bool as_json = false;
  bool resolved = false;
  bool keys = false;
  bool protocols = false;
};

/// The arms of a URDF are on standard output already.
struct Listed : ConfigError {
  using ConfigError::ConfigError;
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

std::string check_arm(const LoadedRobot& robot, const Arguments& given) {
  if (given.resolved) return robot_json(robot) + "\n";
  const ArmReport report = make_arm_report(robot);
  return given.as_json ? arm_json(robot, report) : arm_text(robot, report);
}

/// Base and tip of the only arm there is; else the arms are listed.
void choose_ends(Arguments* given) {
  const UrdfTree tree = read_urdf_tree(given->urdf);
  const std::vector<UrdfArm> arms = find_arms(tree);
  if (arms.size() == 1 && arms.front().also.empty()) {
    if (given->base.empty()) given->base = arms.front().base;
    if (given->tip.empty()) given->tip = arms.front().tip;
    return;
  }
  const std::string problem =
      ConfigError::at(given->urdf, 0, "",
                      arms.empty() ? "no moving joint: not an arm"
                                   : "which arm? give --base LINK and --tip LINK")
          .what();
  if (given->as_json) {
    std::fputs(arms_json(problem, arms).c_str(), stdout);
  } else if (!arms.empty()) {
    std::fputs(arms_text(given->urdf, arms).c_str(), stdout);
  }
  std::fflush(stdout);
  throw Listed(problem);
}

std::string check_urdf_file(Arguments given) {
  const std::vector<double> gravity = parse_gravity(given.gravity);
  if (given.base.empty() || given.tip.empty()) choose_ends(&given);
  return check_arm(load_urdf(given.urdf, given.base, given.tip, gravity.data()), given);
}

std::string check(const Arguments& given) {
  if (given.keys) return required_keys_table();
  if (given.protocols) return protocols_json();
  if (!given.urdf.empty()) return check_urdf_file(given);
  if (given.scenario.empty()) return check_arm(load_robot(given.robot), given);
  controller::load_laws(scenario_laws(given.scenario));
  std::string note;
  LoadedRobot robot =
      load_robot(given.robot.empty() ? scenario_robot(given.scenario, &note) : given.robot);
  if (!note.empty()) robot.notes.insert(robot.notes.begin(), note);
  const Scenario scenario = load_scenario(given.scenario, robot, &controller::law_catalog());
  check_wire_delay(robot.robot, scenario.wire.delay_s, scenario.path);
  return given.as_json ? scenario_json(scenario, robot) : scenario_text(scenario, robot);
}

void define(CommandLine& line, Arguments* given) {
  auto& robot = line.command("robot", "a robot: robot.yaml with its URDF");
  robot.text("robot", &given->robot, "name of a shipped robot, or a folder").required();
  auto& urdf = line.command("urdf", "a URDF by itself");
  urdf.text("file", &given->urdf, "URDF file").required();
  urdf.text("--base", &given->base, "link the arm is fixed by; without it: lists the arms");
  urdf.text("--tip", &given->tip, "link the arm works with");
  urdf.text("--gravity", &given->gravity, "x,y,z in m/s^2, axes of the URDF's root link");
  auto& scenario = line.command("scenario", "a scenario file, against its robot");
  scenario.text("file", &given->scenario, "scenario file").required();
  scenario.text("--robot", &given->robot, "name or folder of another robot than the file's");
  auto& law = line.command("law", "a law of your own: the shared library it was compiled to");
  law.text("file", &given->law_file, "shared library").required();
  auto& keys = line.command("keys", "lists the keys that every robot.yaml needs, in Markdown");
  keys.when_chosen([given] { given->keys = true; });
  auto& protocols = line.command("protocols", "lists the drive protocols, as JSON");
  protocols.when_chosen([given] { given->protocols = true; });
  for (auto* command : {&robot, &urdf, &scenario})
    command->flag("--json", &given->as_json, "print one JSON object");
  for (auto* command : {&robot, &urdf})
    command->flag("--resolved", &given->resolved,
                  "print what was read, in full, as JSON; no report");
}

int check_law(const std::string& file) {
  bool passed = false;
  std::fputs(check_law_file(file, &passed).c_str(), stdout);
  return passed ? kExitDone : 1;
}

int run(const Arguments& given) {
  if (!given.law_file.empty()) return check_law(given.law_file);
  try {
    std::fputs(check(given).c_str(), stdout);
  } catch (const Listed& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return kExitWrongInput;
  } catch (const ConfigError& error) {
    if (given.as_json) std::fputs(refusal_json(error.what()).c_str(), stdout);
    std::fprintf(stderr, "%s\n", error.what());  // file:line: ..., one a line, as compilers print
    return kExitWrongInput;
  }
  return kExitDone;
}

}  // namespace

LIMBER_MAIN(check) {
  CommandLine line("limber-check",
                   "Checks robots, URDFs and scenarios. Exit status 0: fine, 2: refused.");
  Arguments given;
  define(line, &given);
  return run_program(line, argc, argv, [&] { return run(given); });
}
