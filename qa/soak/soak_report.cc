#include "qa/soak/soak_report.h"

#include <nlohmann/json.hpp>

namespace limber::soak {
namespace {

constexpr std::array kInjected = {"silent", "frozen_encoder", "drive_error", "drop_commands"};
constexpr std::array kCauses = {
    "none",          "controller_lost", "command_refused", "reply_lost", "drive_error",
    "configuration", "position",        "velocity",        "bus",        "overrun",
    "requested",     "reply_invalid",   "foreign_command", "feedback",   "emergency_stop",
    "temperature"};

template <typename Names>
std::string name_in(const Names& names, int index) {
  const auto i = static_cast<std::size_t>(index);
  return i < names.size() ? names[i] : std::to_string(index);
}

nlohmann::ordered_json json_of(const ProcessSize& size) {
  return {{"resident_kB", size.resident_kB}, {"descriptors", size.descriptors}};
}

}  // namespace

std::string report_json(const SoakResult& result, const Robot& robot, std::uint64_t seed,
                        double wall_s) {
  const double arm_s = static_cast<double>(result.cycles) / robot.rate_hz;
  nlohmann::ordered_json json = {
      {"robot", robot.name},     {"seed", seed},     {"arm_time_h", arm_s / 3600.0},
      {"cycles", result.cycles}, {"wall_s", wall_s}, {"times_real_time", arm_s / wall_s},
  };
  for (std::size_t i = 0; i < kActionNames.size(); ++i)
    json["actions"][kActionNames[i]] = result.actions[i];
  json["requests_refused"] = result.refused;
  if (result.refused.empty()) json["requests_refused"] = nlohmann::ordered_json::object();
  json["reactions"] = nlohmann::ordered_json::object();
  for (const auto& [pair, count] : result.trips)
    json["reactions"][name_in(kInjected, pair.first)][name_in(kCauses, pair.second)] = count;
  json["recoveries"] = result.recoveries;
  json["longest_recovery_s"] = result.longest_recovery_s;
  json["put_back"] = result.put_back;
  json["other_trips"] = nlohmann::ordered_json::object();
  for (const auto& [cause, count] : result.other_trips)
    json["other_trips"][name_in(kCauses, cause)] = count;
  json["process"] = {{"after_a_minute", json_of(result.size_begin)},
                     {"at_the_end", json_of(result.size_end)},
                     {"most", json_of(result.size_most)}};
  json["violations"] = result.violations;
  return json.dump(2) + "\n";
}

}  // namespace limber::soak
