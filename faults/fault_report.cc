#include "faults/fault_report.h"

#include <algorithm>
#include <limber/joint_state_t.hpp>
#include <nlohmann/json.hpp>

#include "common/config_error.h"
#include "common/suggest.h"
#include "faults/fault_table.h"
#include "robots/loader/protocols/drive_protocol.h"

namespace limber::faults {
namespace {

using Json = nlohmann::ordered_json;

/// The worst of several phases: none of them noticed counts as worse than late.
Json worst(const std::vector<Reaction>& all) {
  const auto by_cycles = [](const Reaction& a, const Reaction& b) { return a.cycles < b.cycles; };
  const auto [least, most] = std::ranges::minmax_element(all, by_cycles);
  const Reaction& told = *most;
  Json out;
  out["cycles"] = Json::array({least->cycles, most->cycles});
  out["state"] = told.state;
  out["cause"] = told.cause;
  out["joint"] = told.joint;
  out["text"] = told.text;
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
  return out;
}

Json row(const Fault& fault, int phases) {
  Json out = {{"name", fault.name},
              {"most_cycles", fault.most_cycles},
              {"watched_cycles", fault.watched_cycles},
              {"from_start", static_cast<bool>(fault.stored)},
              {"families", Json::object()}};
  for (const Family& family : families()) {
    if (!applies(fault, family.protocol)) continue;
    const LoadedRobot robot = load_robot(family.robot);
    std::vector<Reaction> all;
    for (int phase = 0; phase < phases; ++phase) all.push_back(react(fault, robot, phase));
    Json cell = worst(all);
    cell["robot"] = family.robot;
    cell["rate_hz"] = robot.robot.rate_hz;
    const JointConfig& joint = robot.robot.joints[0];
    cell["joint_name"] = joint.name;
    cell["bus"] = robot.robot.buses[static_cast<std::size_t>(joint.drive.bus)].name;
    out["families"][traits_of(family.protocol).word] = std::move(cell);
  }
  return out;
}

}  // namespace

std::string report_json(int phases, const std::string& name) {
  Json json = {{"faults", Json::array()}};
  for (const Fault& fault : fault_table()) {
    if (name.empty() || fault.name == name) json["faults"].push_back(row(fault, phases));
  }
  if (json["faults"].empty()) {
    std::vector<std::string> names;
    for (const Fault& fault : fault_table()) names.push_back(fault.name);
    const std::string near = nearest_word(name, names);
    throw ConfigError(
        "no fault '" + name + "'" +
        (near.empty() ? "; there are: " + joined(names) : "; did you mean '" + near + "'?"));
  }
  return json.dump(2) + "\n";
}

}  // namespace limber::faults
