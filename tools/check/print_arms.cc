#include <fmt/format.h>

#include <algorithm>

#include "common/joints.h"
#include "common/suggest.h"
#include "tools/check/json.h"
#include "tools/check/print.h"

namespace limber {
namespace {

std::string row(const UrdfArm& arm) {
  std::string text = fmt::format("  {:>6}  {}", arm.joints.size(), joined(arm.joints));
  if (arm.joints.size() > kMaxJoints) text += fmt::format(" (more than {})", kMaxJoints);
  text += fmt::format("\n          --base {} --tip {}\n", arm.base, arm.tip);
  if (!arm.also.empty()) text += fmt::format("          or tip: {}\n", joined(arm.also));
  return text;
}

}  // namespace

std::string arms_text(const std::string& file, const std::vector<UrdfArm>& arms) {
  constexpr std::size_t kRows = 40;
  std::string text = fmt::format("{}: {} chain{}; any link on the way may be the base\n", file,
                                 arms.size(), arms.size() == 1 ? "" : "s");
  text += "  joints  names, and the options that choose this arm\n";
  for (std::size_t i = 0; i < std::min(kRows, arms.size()); ++i) text += row(arms[i]);
  if (arms.size() > kRows) text += fmt::format("  and {} more\n", arms.size() - kRows);
  return text;
}

std::string arms_json(const std::string& problem, const std::vector<UrdfArm>& arms) {
  std::vector<std::string> listed;
  for (const UrdfArm& arm : arms) {
    listed.push_back(json::object({{"base", json::text(arm.base)},
                                   {"tip", json::text(arm.tip)},
                                   {"also", json::texts(arm.also)},
                                   {"joints", json::texts(arm.joints)}}));
  }
  return json::object({{"ok", "false"},
                       {"complaints", json::texts({problem})},
                       {"chains", json::list(listed)}}) +
         "\n";
}

}  // namespace limber
