#include <fmt/format.h>

#include <algorithm>

#include "lcmtypes/mode_words.h"
#include "scenarios/loader/world_yaml.h"
#include "tools/check/pose_report.h"
#include "tools/check/print.h"
#include "tools/check/refusal_report.h"
#include "tools/check/scenario_json.h"
#include "tools/check/stiffness_report.h"

namespace limber {
namespace {

std::string three(const double* values) {
  return fmt::format("[{:g}, {:g}, {:g}]", values[0], values[1], values[2]);
}

std::string describe(const mode_request_t& request) {
  return fmt::format("mode {}", kModeRequestWords[static_cast<std::size_t>(request.request)]);
}

std::string describe(const compliance_gains_t& gains) {
  double diagonal[6];
  for (int i = 0; i < 6; ++i) diagonal[i] = gains.K_x[i][i];
  return fmt::format("gains: {}, K_x diagonal {} N/m {} N m/rad, over {:g} s",
                     gains.law.empty() ? "same law" : gains.law, three(diagonal),
                     three(diagonal + 3), gains.ramp_s);
}

std::string describe(const compliance_goal_t& goal) {
  const char* const names[] = {"pose", "joints", "offset", "wrench", "circle"};
  return fmt::format("goal: {} within {:g} s", names[goal.kind], goal.duration_s);
}

std::string describe(const target_stream_t& stream) {
  const char* const names[] = {"joints", "poses", "twists"};
  return fmt::format("stream: {} {} over {:g} s, {:g} s late", int{stream.num_knots},
                     names[stream.kind], stream.dt_s[stream.num_knots - 1], stream.delay_s);
}

std::string describe(const hand_goal_t& goal) {
  return fmt::format("hand to {:g} m", goal.width_m);
}

std::string describe(const push_t& push) {
  return fmt::format("push {} at {}: {} N {} N m for {:g} s", push.id,
                     push.link.empty() ? "the tip" : push.link, three(push.wrench),
                     three(push.wrench + 3), push.duration_s);
}

std::string describe(const scenario_event_t& event) {
  if (event.kind == scenario_event_t::EVENT_FAULT) {
    const std::string who = event.joint == scenario_event_t::NODE_TIP_SENSOR
                                ? "tip sensor"
                                : fmt::format("joint {}", event.joint);
    return fmt::format("fault: {} {}{}", who, fault_word(event.fault),
                       event.duration_s > 0.0 ? fmt::format(" for {:g} s", event.duration_s) : "");
  }
  if (event.kind == scenario_event_t::EVENT_PAYLOAD) {
    return event.payload_mass_kg > 0.0 ? fmt::format("payload of {:g} kg", event.payload_mass_kg)
                                       : "payload off";
  }
  if (event.stiffness_N_per_m <= 0.0) return "wall off";
  return fmt::format("wall through {} m, normal {}, {:g} N/m", three(event.point),
                     three(event.normal), event.stiffness_N_per_m);
}

std::string describe(const TimedMessage& timed) {
  return std::visit([](const auto& message) { return describe(message); }, timed.message);
}

const char* mode_name(const Scenario& scenario) {
  return scenario.lockstep ? "lockstep" : "realtime";
}
const char* integrator_name(const Scenario& scenario) {
  return scenario.integrator == Integrator::kOde ? "ode" : "reference";
}

std::vector<std::string> all_notes(const Scenario& scenario, const LoadedRobot& robot) {
  std::vector<std::string> notes = robot.notes;
  for (std::string& note : pose_notes(scenario, robot.robot)) notes.push_back(std::move(note));
  return notes;
}

}  // namespace

std::string scenario_text(const Scenario& scenario, const LoadedRobot& robot) {
  std::string text = fmt::format(
      "{}: {}, {:g} s, {}, {} integrator at {:g} ms, friction {}, seed {}\n", scenario.name,
      robot.robot.name, scenario.duration_s, mode_name(scenario), integrator_name(scenario),
      scenario.step_s * 1e3, scenario.friction ? "on" : "off", scenario.seed);
  if (scenario.plant)
    text += "  the simulated arm differs from robot.yaml (plant_overrides, friction)\n";
  for (const TimedMessage& timed : scenario.timeline) {
    text += fmt::format("  {:8.3f} s  {}\n", static_cast<double>(timed.time_ns) * 1e-9,
                        describe(timed));
  }
  for (const std::string& note : all_notes(scenario, robot)) text += "  note: " + note + "\n";
  if (!robot.robot.has_drives) return text;
  const auto reports = make_stiffness_reports(scenario, robot);
  text += stiffness_text(reports, robot.robot.rate_hz);
  for (const auto& warnings :
       {stiffness_warnings(reports, robot.robot), doubtful_requests(scenario, robot)}) {
    for (const std::string& warning : warnings) text += "  warning: " + warning + "\n";
  }
  return text;
}

std::string scenario_json(const Scenario& scenario, const LoadedRobot& robot) {
  std::vector<StiffnessReport> reports;
  if (robot.robot.has_drives) reports = make_stiffness_reports(scenario, robot);
  json::Members members = scenario_members(scenario, robot);
  members.insert(members.begin(), {"ok", "true"});
  members.insert(members.end(),
                 {{"stiffness", stiffness_json(reports)},
                  {"warnings", json::texts(stiffness_warnings(reports, robot.robot))},
                  {"refused", json::texts(doubtful_requests(scenario, robot))},
                  {"notes", json::texts(all_notes(scenario, robot))}});
  return json::object(members) + "\n";
}

}  // namespace limber
