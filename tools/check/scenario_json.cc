#include "tools/check/scenario_json.h"

#include <fmt/format.h>

#include "controller/arm_controller.h"
#include "lcmtypes/gains_merge.h"
#include "lcmtypes/mode_words.h"
#include "robots/loader/default_gains.h"
#include "scenarios/loader/world_yaml.h"
#include "tools/check/robot_json.h"

namespace limber {
namespace {

template <std::size_t n>
std::string array_json(const double (&values)[n]) {
  return json::numbers({std::begin(values), std::end(values)});
}

std::string at_s(const TimedMessage& timed) {
  return json::number(static_cast<double>(timed.time_ns) / 1e9);
}

json::Members members_of(const mode_request_t& request) {
  return {{"mode", json::text(kModeRequestWords[static_cast<std::size_t>(request.request)])}};
}

/// See gains_over_time().
json::Members members_of(const compliance_gains_t& gains) {
  return {{"gains", json::texts(gains.named)}};
}

json::Members members_of(const compliance_goal_t& goal) {
  const char* const kinds[] = {"pose", "joints", "offset", "wrench", "circle"};
  json::Members members = {{"kind", json::text(kinds[goal.kind])}};
  if (goal.kind == compliance_goal_t::GOAL_OFFSET)
    members.emplace_back("offset_m_rad", array_json(goal.offset));
  return {{"goal", json::object(members)}};
}

json::Members members_of(const target_stream_t& stream) {
  const char* const kinds[] = {"joints", "pose", "twist"};
  return {{"stream", json::object({{"kind", json::text(kinds[stream.kind])},
                                   {"knots", json::number(stream.num_knots)}})}};
}

json::Members members_of(const hand_goal_t& goal) {
  return {{"hand", json::object({{"width_m", json::number(goal.width_m)},
                                 {"force_N", json::number(goal.force_N)},
                                 {"speed_m_per_s", json::number(goal.speed_m_per_s)}})}};
}

json::Members members_of(const push_t& push) {
  return {{"push", json::object({{"link", json::text(push.link)},
                                 {"wrench_N_Nm", array_json(push.wrench)},
                                 {"ramp_s", json::number(push.ramp_s)},
                                 {"for_s", json::number(push.duration_s)}})}};
}

/// A wall or payload that is taken away is null.
json::Members members_of(const scenario_event_t& event) {
  if (event.kind == scenario_event_t::EVENT_FAULT)
    return {{"fault", json::text(fault_word(event.fault))}};
  if (event.kind == scenario_event_t::EVENT_PAYLOAD) {
    const bool there = event.payload_mass_kg > 0.0;
    return {{"payload_kg", there ? json::number(event.payload_mass_kg) : "null"}};
  }
  if (!(event.stiffness_N_per_m > 0.0)) return {{"wall", "null"}};
  return {{"wall", json::object({{"point_m", array_json(event.point)},
                                 {"normal", array_json(event.normal)},
                                 {"stiffness_N_per_m", json::number(event.stiffness_N_per_m)}})}};
}

std::string timeline_json(const Scenario& scenario) {
  std::vector<std::string> entries;
  for (const TimedMessage& timed : scenario.timeline) {
    json::Members members =
        std::visit([](const auto& message) { return members_of(message); }, timed.message);
    members.insert(members.begin(), {"at_s", at_s(timed)});
    entries.push_back(json::object(members));
  }
  return json::list(entries);
}

/// The word of a choice.
std::string word_of(const char* key, const compliance_gains_t& gains) {
  for (const GainRow& row : gain_table()) {
    if (std::string_view(row.key) != key) continue;
    const auto value = gains.*std::get<std::int8_t compliance_gains_t::*>(row.field);
    for (const GainWord& word : row.words) {
      if (word.value == value) return word.word;
    }
  }
  return "";
}

std::string gains_json(const std::string& since_s, const std::string& law,
                       const compliance_gains_t& gains) {
  std::vector<std::string> K_x;
  for (const auto& row : gains.K_x) K_x.push_back(array_json(row));
  return json::object(
      {{"at_s", since_s},
       {"law", json::text(law)},
       {"K_x", json::list(K_x)},
       {"K_q_Nm_per_rad", json::numbers({gains.K_q, gains.K_q + gains.num_joints})},
       {"frame", json::text(word_of("frame", gains))},
       {"friction_compensation", json::text(word_of("friction_compensation", gains))},
       {"friction_share", fmt::format("{}", gains.friction_share)}});
}

/// What holds from each time on; the first is what a controller starts with.
std::string gains_over_time(const Scenario& scenario, const Robot& robot) {
  std::string law = ArmControllerOptions().law;
  compliance_gains_t present = default_gains(robot);
  std::vector<std::string> found = {gains_json("0", law, present)};
  for (const TimedMessage& timed : scenario.timeline) {
    const auto* request = std::get_if<compliance_gains_t>(&timed.message);
    if (request == nullptr) continue;
    merge_gains(*request, &present);
    if (!request->law.empty()) law = request->law;
    found.push_back(gains_json(at_s(timed), law, present));
  }
  return json::list(found);
}

std::string objects_json(const std::vector<ObjectConfig>& objects) {
  std::vector<std::string> all;
  for (const ObjectConfig& object : objects)
    all.push_back(json::object({{"name", json::text(object.name)},
                                {"position_m", array_json(object.p_B)},
                                {"width_m", json::number(object.width_m)},
                                {"stiffness_N_per_m", json::number(object.stiffness_N_per_m)},
                                {"damping_Ns_per_m", json::number(object.damping_Ns_per_m)},
                                {"mass_kg", json::number(object.mass_kg)},
                                {"friction", json::number(object.friction)}}));
  return json::list(all);
}

}  // namespace

json::Members scenario_members(const Scenario& scenario, const LoadedRobot& robot) {
  const bool ode = scenario.integrator == Integrator::kOde;
  return {
      {"format", json::text("limber-resolved-scenario/1")},
      {"name", json::text(scenario.name)},
      {"robot", robot_json(robot)},
      {"mode", json::text(scenario.lockstep ? "lockstep" : "realtime")},
      {"duration_s", json::number(scenario.duration_s)},
      {"integrator", json::text(ode ? "ode" : "reference")},
      {"step_s", json::number(scenario.step_s)},
      {"friction", json::flag(scenario.friction)},
      {"friction_factor", json::number(scenario.friction_factor)},
      {"seed", fmt::format("{}", scenario.seed)},
      {"record", json::flag(scenario.record)},
      {"law_files", json::texts(scenario.law_files)},
      {"measure", json::object({{"stiffness", json::number(scenario.measure.stiffness)},
                                {"contact_force", json::number(scenario.measure.contact_force)}})},
      {"plant_overrides", json::flag(scenario.plant.has_value())},
      {"start_q", json::numbers(scenario.start_q)},
      {"objects", objects_json(scenario.objects)},
      {"gains", gains_over_time(scenario, robot.robot)},
      {"timeline", timeline_json(scenario)}};
}

}  // namespace limber
