#include "tools/ask/asker.h"

#include <fmt/format.h>

#include <array>
#include <variant>

#include "common/clock.h"
#include "common/config_error.h"
#include "lcmtypes/channels.h"
#include "scenarios/gains_yaml.h"

namespace limber {
namespace {

constexpr std::int64_t kFirstStatus_ns = 1'000'000'000;
constexpr std::int64_t kAnswer_ns = 500'000'000;
constexpr int kStatusQueue = 16;

template <typename... Handlers>
struct Overloaded : Handlers... {
  using Handlers::operator()...;
};

// The same words as in a scenario, at no particular time.
std::string as_entry(const std::string& text) {
  const auto brace = text.find_first_not_of(" \t");
  if (brace != std::string::npos && text[brace] == '{') {
    return "{at_s: 0, " + text.substr(brace + 1);
  }
  return "{at_s: 0, " + text + "}";
}

}  // namespace

Asker::Asker(const LoadedRobot& robot, std::int64_t client)
    : robot_(robot),
      client_(client),
      context_{robot_, 0.0, default_gains(robot.robot)},
      port_(user_plane_url()) {
  port_.subscribe<controller_status_t>(
      channels::kControllerStatus, kStatusQueue,
      [this](const controller_status_t& status) { status_ = status; });
}

bool Asker::wait_for_status(std::int64_t timeout_ns) {
  const std::int64_t end_ns = monotonic_ns() + timeout_ns;
  const std::array descriptors{port_.descriptor()};
  status_.reset();
  while (!status_ && monotonic_ns() < end_ns) {
    if (wait_readable(descriptors, end_ns)) port_.handle_waiting();
  }
  return status_.has_value();
}

void Asker::ask(const std::string& entry) {
  const YamlMap yaml = YamlMap::from_text(as_entry(entry), "request");
  const TimedMessage timed = read_entry(yaml, &context_);
  const bool to_controller = !std::holds_alternative<push_t>(timed.message) &&
                             !std::holds_alternative<scenario_event_t>(timed.message);
  if (!to_controller) {
    send(timed.message);
    return;
  }
  if (!wait_for_status(kFirstStatus_ns)) throw ConfigError("no controller is heard");
  const std::int64_t refused = status_->requests_refused;
  send(timed.message);
  // The first status may have been on its way already.
  if (!wait_for_status(kAnswer_ns) || !wait_for_status(kAnswer_ns)) {
    throw ConfigError("the controller has fallen silent");
  }
  if (status_->requests_refused > refused) {
    throw ConfigError("refused by the controller; its output says why");
  }
}

void Asker::send(const ScenarioMessage& message) {
  const auto publish = [this](const char* channel, auto copy) {
    copy.time_ns = monotonic_ns();
    if constexpr (requires { copy.client; }) copy.client = client_;
    if (!port_.publish(channel, copy)) throw ConfigError("the message could not be sent");
  };
  std::visit(Overloaded{
                 [&](const mode_request_t& m) { publish(channels::kModeRequest, m); },
                 [&](const compliance_goal_t& m) { publish(channels::kComplianceGoal, m); },
                 [&](const compliance_gains_t& m) { publish(channels::kComplianceGains, m); },
                 [&](const push_t& m) { publish(channels::kPush, m); },
                 [&](const scenario_event_t& m) { publish(channels::kScenarioEvent, m); },
             },
             message);
}

}  // namespace limber
