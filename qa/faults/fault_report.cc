#include "qa/faults/fault_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <limber/joint_state_t.hpp>
#include <nlohmann/json.hpp>

#include "common/config_error.h"
#include "common/suggest.h"
#include "qa/faults/families.h"
#include "qa/faults/fault_table.h"
#include "robots/loader/protocols/drive_protocol.h"

namespace limber::faults {
namespace {

using Json = nlohmann::ordered_json;

Json as_json(const Reaction& reaction) {
  return {{"cycles", reaction.cycles},       {"state", reaction.state},
          {"cause", reaction.cause},         {"joint", reaction.joint},
          {"text", reaction.text},           {"fault_cycles", reaction.fault_cycles},
          {"lost", reaction.lost},           {"late", reaction.late},
          {"invalid", reaction.invalid},     {"foreign", reaction.foreign},
          {"refused", reaction.refused},     {"verdict", reaction.verdict},
          {"returned", reaction.returned},   {"moved_on_rad", reaction.moved_on_rad},
          {"moved_rad", reaction.moved_rad}, {"speed_rad_per_s", reaction.speed_rad_per_s},
          {"fault_ns", reaction.fault_ns}};
}

/// The worst of several phases: none of them noticed counts as worse than late.
Json worst(const std::vector<Reaction>& all) {
  const auto by_cycles = [](const Reaction& a, const Reaction& b) { return a.cycles < b.cycles; };
  const auto [least, most] = std::ranges::minmax_element(all, by_cycles);
  Json out = as_json(*most);
  out["cycles"] = Json::array({least->cycles, most->cycles});
  const auto greatest = [&](auto member) {
    auto value = all.front().*member;
    for (const Reaction& one : all) value = std::max(value, one.*member);
    return value;
  };
  out["fault_cycles"] = greatest(&Reaction::fault_cycles);
  out["lost"] = greatest(&Reaction::lost);
  out["late"] = greatest(&Reaction::late);
  out["invalid"] = greatest(&Reaction::invalid);
  out["foreign"] = greatest(&Reaction::foreign);
  out["refused"] = greatest(&Reaction::refused);
  out["returned"] = greatest(&Reaction::returned);
  out["moved_on_rad"] = greatest(&Reaction::moved_on_rad);
  out["moved_rad"] = greatest(&Reaction::moved_rad);
  out["speed_rad_per_s"] = greatest(&Reaction::speed_rad_per_s);
  out["each"] = Json::array();
  for (const Reaction& one : all) out["each"].push_back(as_json(one));
  return out;
}

bool is_wanted(const std::string& wanted, const std::string& word) {
  return wanted.empty() || wanted == word;
}

std::string trace_of(const ReportOptions& options, const std::string& protocol, int phase) {
  return options.traces.empty() ? "" : fmt::format("{}/{}-{}.log", options.traces, protocol, phase);
}

Json row(const Fault& fault, const ReportOptions& options) {
  Json out = {{"name", fault.name},
              {"place", name_of(fault.place)},
              {"most_cycles", fault.most_cycles},
              {"watched_cycles", fault.watched_cycles},
              {"from_start", static_cast<bool>(fault.stored)},
              {"families", Json::object()}};
  for (const Family& family : families()) {
    const std::string word(family.protocol);
    if (!applies(fault, family.protocol) || !is_wanted(options.family, word)) continue;
    const LoadedRobot robot = load_robot(family.robot);
    std::vector<Reaction> all;
    for (int phase = 0; phase < options.phases; ++phase)
      all.push_back(react(fault, robot, {phase, trace_of(options, word, phase)}));
    Json cell = worst(all);
    cell["robot"] = family.robot;
    cell["rate_hz"] = robot.robot.rate_hz;
    const JointConfig& joint = robot.robot.joints[0];
    cell["joint_name"] = joint.name;
    cell["bus"] = robot.robot.buses[static_cast<std::size_t>(joint.drive.bus)].name;
    out["families"][word] = std::move(cell);
  }
  return out;
}

void check_word(const char* what, const std::string& found, const std::vector<std::string>& words) {
  if (found.empty() || std::ranges::find(words, found) != words.end()) return;
  const std::string near = nearest_word(found, words);
  throw ConfigError(fmt::format(
      "no {} '{}'{}", what, found,
      near.empty() ? "; there are: " + joined(words) : "; did you mean '" + near + "'?"));
}

void check(const ReportOptions& options) {
  std::vector<std::string> names;
  for (const Fault& fault : fault_table()) names.push_back(fault.name);
  check_word("fault", options.fault, names);
  check_word("place", options.place,
             {name_of(Place::kBus), name_of(Place::kController), name_of(Place::kFeedback)});
  check_word("family", options.family, protocol_words());
}

}  // namespace

std::string report_json(const ReportOptions& options) {
  check(options);
  Json json = {{"faults", Json::array()}};
  for (const Fault& fault : fault_table()) {
    if (is_wanted(options.fault, fault.name) && is_wanted(options.place, name_of(fault.place)))
      json["faults"].push_back(row(fault, options));
  }
  return json.dump(2) + "\n";
}

std::string list_json() {
  Json json = {{"faults", Json::array()}};
  for (const Fault& fault : fault_table()) {
    Json protocols = Json::array();
    for (const Family& family : families()) {
      if (applies(fault, family.protocol)) protocols.push_back(family.protocol);
    }
    json["faults"].push_back(
        {{"name", fault.name}, {"place", name_of(fault.place)}, {"families", protocols}});
  }
  return json.dump(2) + "\n";
}

}  // namespace limber::faults
