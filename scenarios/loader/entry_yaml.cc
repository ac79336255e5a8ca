#include "scenarios/loader/entry_yaml.h"

#include <fmt/format.h>

#include <cmath>

#include "common/suggest.h"
#include "lcmtypes/mode_words.h"
#include "scenarios/loader/gains_yaml.h"
#include "scenarios/loader/goal_yaml.h"
#include "scenarios/loader/hand_yaml.h"
#include "scenarios/loader/stream_yaml.h"
#include "scenarios/loader/values_yaml.h"
#include "scenarios/loader/world_yaml.h"

namespace limber {
namespace {

const std::vector<std::string> kKinds = {"mode", "gains", "goal",    "stream", "hand",
                                         "push", "wall",  "payload", "fault"};
const std::vector<std::string> kModes(kModeRequestWords.begin(), kModeRequestWords.end());

ScenarioMessage read_message(const YamlMap& yaml, const std::string& kind,
                             const EntryContext& context) {
  if (kind == "mode") return mode_request(index_of(yaml.word("mode", kModes), kModes));
  if (kind == "gains") {
    compliance_gains_t gains =
        read_gains_entry(yaml.map("gains"), context.robot.robot, *context.laws);
    gains.client = kScenarioClient;
    return gains;
  }
  if (kind == "stream") return read_stream(yaml.map("stream"), context.robot.robot);
  if (kind == "goal") return read_goal(yaml.map("goal"), context.robot.robot);
  if (kind == "hand") return read_hand_goal(yaml.map("hand"), context.robot.robot);
  if (kind == "push") return read_push(yaml.map("push"), context.robot);
  if (kind == "wall") return read_wall(yaml);
  if (kind == "payload") return read_payload(yaml);
  return read_fault(yaml.map("fault"), context.robot.robot);
}

}  // namespace

mode_request_t mode_request(int request) {
  mode_request_t message{};
  message.client = kScenarioClient;
  message.request = static_cast<std::int8_t>(request);
  return message;
}

std::optional<TimedMessage> read_entry(const YamlMap& yaml, const EntryContext& context) {
  const double at_s = yaml.number("at_s", {0.0, context.duration_s});
  std::vector<std::string> there;
  for (const std::string& kind : kKinds) {
    if (yaml.has(kind)) there.push_back(kind);
  }
  yaml.finish();
  if (there.size() != 1) {
    yaml.refuse(fmt::format("an entry holds at_s and exactly one of: {}; found {}", joined(kKinds),
                            there.empty() ? "none" : joined(there)));
  }
  if (there.front() == "gains" && context.laws == nullptr) return std::nullopt;
  return TimedMessage{std::llround(at_s * 1e9), read_message(yaml, there.front(), context)};
}

}  // namespace limber
