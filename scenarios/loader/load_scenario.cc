#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

#include "common/complaints.h"
#include "common/yaml_reader.h"
#include "scenarios/loader/entry_yaml.h"
#include "scenarios/loader/hand_yaml.h"
#include "scenarios/loader/plant_overrides.h"
#include "scenarios/loader/scenario_yaml.h"
#include "scenarios/loader/values_yaml.h"

namespace limber {
namespace {

constexpr const char* kFormat = "limber-scenario/1";
// Requests of a file that makes none: time to see the drives answer, then time to hold still.
constexpr std::int64_t kHoldAt_ns = 300'000'000;
constexpr std::int64_t kActiveAt_ns = 800'000'000;

std::vector<double> read_start(const YamlMap& yaml, const Robot& robot) {
  std::vector<double> start;
  for (const JointConfig& joint : robot.joints) start.push_back(joint.home);
  if (!yaml.has("start_q")) return start;
  read_joint_pose(yaml, "start_q", robot, start.data());
  return start;
}

double read_step(const YamlMap& yaml, double rate_hz) {
  const double step_s = yaml.number_or("step_s", {1e-6, 0.1}, Scenario().step_s);
  const double steps = 1.0 / (rate_hz * step_s);
  if (!(steps >= 0.5 && std::abs(steps - std::round(steps)) <= 1e-6 * steps)) {
    yaml.refuse("step_s", fmt::format("{} s: a whole number of steps must make the control period "
                                      "of {} s",
                                      step_s, 1.0 / rate_hz));
  }
  return step_s;
}

/// Same joints, same buses: only what an arm is like may differ.
LoadedRobot read_plant(const YamlMap& yaml, const LoadedRobot& robot) {
  check_plant_keys(yaml);
  LoadedRobot real = load_plant(robot.robot.folder, yaml);
  check_plant_sensors(yaml, robot.robot, real.robot);
  return real;
}

/// `true`, `false`, or how much of robot.yaml's friction the simulated arm has.
double read_friction(const YamlMap& yaml) {
  const std::string text = yaml.text_or("friction", "true");
  if (std::isalpha(static_cast<unsigned char>(text[0])) != 0)
    return yaml.boolean_or("friction", true) ? 1.0 : 0.0;
  return yaml.number("friction", {0.0, 10.0});
}

void scale_friction(double factor, Robot* robot) {
  for (JointConfig& joint : robot->joints) {
    for (FrictionConfig* friction : {&joint.friction, &joint.link_friction}) {
      friction->coulomb_Nm *= factor;
      friction->static_Nm *= factor;
      friction->viscous_Nms_per_rad *= factor;
    }
  }
}

WireOptions read_wire(const YamlMap& yaml, std::uint64_t seed) {
  WireOptions wire{.on = true, .seed = seed};
  if (!yaml.has("wire")) return wire;
  if (!yaml.is_map("wire")) {
    wire.on = yaml.boolean_or("wire", true);
    return wire;
  }
  const YamlMap given = yaml.map("wire");
  wire.loss = given.number_or("loss", {0.0, 1.0}, 0.0);
  wire.corruption = given.number_or("corruption", {0.0, 1.0}, 0.0);
  wire.delay_s = given.number_or("delay_s", {0.0, 0.5}, 0.0);
  given.finish();
  return wire;
}

/// A mapping; a list is for the experiment tools.
MeasureTolerances read_measure(const YamlMap& yaml) {
  MeasureTolerances measure;
  if (!yaml.has("measure") || yaml.is_list("measure")) return measure;
  if (!yaml.is_map("measure"))
    yaml.refuse("measure", "expected a mapping or a list (read by the experiment tools)");
  const YamlMap given = yaml.map("measure");
  const Range share = {1e-6, 1.0};
  measure.stiffness = given.number_or("stiffness", share, measure.stiffness);
  measure.contact_force = given.number_or("contact_force", share, measure.contact_force);
  given.finish();
  return measure;
}

void set_seq(std::int64_t seq, std::int64_t time_ns, ScenarioMessage* message) {
  std::visit(
      [&](auto& typed) {
        typed.seq = seq;
        typed.time_ns = time_ns;
      },
      *message);
}

std::vector<TimedMessage> read_timeline(const YamlMap& yaml, const LoadedRobot& robot,
                                        const LawCatalog* laws, double duration_s) {
  std::vector<TimedMessage> timeline;
  const EntryContext context{robot, laws, duration_s};
  bool asks_for_mode = false;
  Complaints complaints(yaml.file());
  if (yaml.has("timeline")) {
    for (const YamlMap& entry : yaml.maps("timeline")) {
      asks_for_mode = asks_for_mode || entry.has("mode");
      complaints.collect([&] {
        if (auto timed = read_entry(entry, context)) timeline.push_back(std::move(*timed));
      });
    }
  }
  complaints.throw_if_any();
  if (!asks_for_mode) {
    timeline.push_back({kHoldAt_ns, mode_request(mode_request_t::REQUEST_HOLD)});
    timeline.push_back({kActiveAt_ns, mode_request(mode_request_t::REQUEST_ACTIVE)});
  }
  std::stable_sort(timeline.begin(), timeline.end(),
                   [](const auto& a, const auto& b) { return a.time_ns < b.time_ns; });
  std::int64_t seq = 0;
  for (TimedMessage& timed : timeline) set_seq(++seq, timed.time_ns, &timed.message);
  return timeline;
}

}  // namespace

std::string scenario_robot(const std::string& path, std::string* note) {
  return scenario_robot(YamlMap::from_file(path), note);
}

std::vector<std::string> scenario_laws(const std::string& path) {
  return path.empty() ? std::vector<std::string>() : scenario_laws(YamlMap::from_file(path));
}

Scenario load_scenario(const std::string& path, const LoadedRobot& robot, const LawCatalog* laws) {
  return load_scenario(YamlMap::from_file(path), robot, laws);
}

std::string scenario_robot(const YamlMap& yaml, std::string* note) {
  namespace fs = std::filesystem;
  const std::string& path = yaml.file();
  yaml.word("format", {kFormat});
  std::string robot = yaml.text("robot");
  const bool is_name = robot.find('/') == std::string::npos && !robot.starts_with('.');
  if (robot.starts_with('/')) return robot;
  const fs::path beside = (fs::path(path).parent_path() / robot).lexically_normal();
  if (!is_name) return beside;
  const bool shipped = is_robot_folder(fs::path(robots_root()) / robot);
  if (!is_robot_folder(beside)) {
    if (!shipped && !is_robot_folder(robot)) yaml.refuse("robot", no_robot_text(robot));
    return robot;
  }
  if (note != nullptr && shipped) {
    *note = fmt::format("{}:{}: robot: '{}' is the folder beside this file, not the shipped robot",
                        path, yaml.line_of("robot"), robot);
  }
  return beside.has_parent_path() ? beside.string() : "./" + beside.string();
}

std::vector<std::string> scenario_laws(const YamlMap& yaml) {
  if (!yaml.has("law_file")) return {};
  return {(std::filesystem::path(yaml.file()).parent_path() / yaml.text("law_file")).string()};
}

Scenario load_scenario(const YamlMap& yaml, const LoadedRobot& robot, const LawCatalog* laws) {
  yaml.word("format", {kFormat});
  const std::string& path = yaml.file();
  Scenario scenario;
  scenario.path = path;
  scenario.name =
      yaml.has("name") ? yaml.name("name") : std::filesystem::path(path).stem().string();
  yaml.text_or("description", "-");
  scenario.robot = yaml.text("robot");
  scenario.lockstep = yaml.word_or("mode", {"lockstep", "realtime"}, "lockstep") == "lockstep";
  scenario.duration_s = yaml.number("duration_s", {0.01, 86'400.0});
  scenario.seed = static_cast<std::uint64_t>(yaml.integer_or("seed", 0, 1L << 53, 1));
  scenario.integrator = yaml.word_or("integrator", {"ode", "reference"}, "ode") == "ode"
                            ? Integrator::kOde
                            : Integrator::kReference;
  scenario.step_s = read_step(yaml, robot.robot.rate_hz);
  scenario.friction_factor = read_friction(yaml);
  scenario.friction = scenario.friction_factor > 0.0;
  scenario.allow_unstable = yaml.boolean_or("allow_unstable", false);
  scenario.wire = read_wire(yaml, scenario.seed);
  scenario.stand = yaml.boolean_or("stand", true);
  const char* overrides = yaml.has("plant_overrides") ? "plant_overrides" : "reality";
  if (yaml.has(overrides)) scenario.plant = read_plant(yaml.map(overrides), robot);
  if (scenario.friction && scenario.friction_factor != 1.0) {
    if (!scenario.plant) scenario.plant = robot;
    scale_friction(scenario.friction_factor, &scenario.plant->robot);
  }
  scenario.start_q = read_start(yaml, robot.robot);
  scenario.objects = read_objects(yaml, robot.robot);
  scenario.measure = read_measure(yaml);
  scenario.record = yaml.boolean_or("record", true);
  scenario.law_files = scenario_laws(yaml);
  yaml.has("timeline");
  yaml.finish();
  scenario.timeline = read_timeline(yaml, robot, laws, scenario.duration_s);
  return scenario;
}

}  // namespace limber
