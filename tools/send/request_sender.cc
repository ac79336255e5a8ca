#include "tools/send/request_sender.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <limber/controller_status_t.hpp>
#include <variant>

#include "common/clock.h"
#include "common/config_error.h"
#include "common/overloaded.h"
#include "common/problem_text.h"
#include "controller/laws/registry.h"
#include "lcmtypes/channels.h"
#include "tools/send/mode_way.h"

namespace limber {
namespace {

constexpr std::int64_t kAnswer_ns = 1'000'000'000;
constexpr int kAnswerQueue = 16;

// The same words as in a scenario, at no particular time.
std::string as_entry(const std::string& text) {
  const auto brace = text.find_first_not_of(" \t");
  if (brace != std::string::npos && text[brace] == '{') {
    return "{at_s: 0, " + text.substr(brace + 1);
  }
  return "{at_s: 0, " + text + "}";
}

}  // namespace

RequestSender::RequestSender(const LoadedRobot& robot, std::int64_t client)
    : robot_(robot),
      client_(client),
      context_{robot_, &controller::law_catalog(), 0.0},
      port_(user_plane_url()) {
  port_.subscribe<request_answer_t>(channels::kRequestAnswer, kAnswerQueue,
                                    [this](const request_answer_t& answer) {
                                      if (answer.client == client_ && answer.seq == seq_)
                                        answer_ = answer;
                                    });
  port_.subscribe<controller_status_t>(channels::kControllerStatus, 1,
                                       [this](const controller_status_t& status) {
                                         controller_ = status.controller;
                                         mode_ = status.mode;
                                       });
}

template <typename Condition>
bool RequestSender::wait_for(Condition met) {
  const std::int64_t end_ns = monotonic_ns() + kAnswer_ns;
  const std::array descriptors{port_.descriptor()};
  while (!met() && monotonic_ns() < end_ns) {
    if (wait_readable(descriptors, end_ns)) port_.handle_waiting();
  }
  return met();
}

std::int64_t RequestSender::running_controller() {
  port_.handle_waiting();  // a status from before may be of another run
  controller_.reset();
  if (!wait_for([this] { return controller_.has_value(); }))
    throw ConfigError("no controller answers");
  return *controller_;
}

void RequestSender::send_entry(const std::string& entry) {
  const YamlMap yaml = YamlMap::from_text(as_entry(entry), "request");
  const TimedMessage timed = *read_entry(yaml, context_);  // laws are known: nothing is left out
  const bool to_controller = !std::holds_alternative<push_t>(timed.message) &&
                             !std::holds_alternative<scenario_event_t>(timed.message);
  send(timed.message, to_controller ? running_controller() : 0);
  if (!to_controller) return;
  const bool answered = wait_for([this] { return answer_.has_value(); });
  // A stream's messages are answered where they are refused.
  if (!answered && std::holds_alternative<target_stream_t>(timed.message)) return;
  if (!answered) throw ConfigError("no controller answers");
  if (answer_->accepted == 0) throw ConfigError("refused by the controller: " + refusal());
  if (!answer_->reason.empty()) spdlog::warn("warning: {}", answer_->reason);
}

std::string RequestSender::refusal() const {
  if (answer_->code != request_answer_t::REFUSED_MODE)
    return refusal_text(answer_->code, answer_->reason);
  // The way there is in the words, so the table's general one is left out.
  return find_problem(problems::kRequest, answer_->code)->code +
         (": " + not_in_mode(mode_, *answer_));
}

void RequestSender::send(const ScenarioMessage& message, std::int64_t controller) {
  answer_.reset();
  // Greater than that of any sender with this client's number before.
  seq_ = std::max(seq_ + 1, monotonic_ns());
  const auto publish = [&](const char* channel, auto copy) {
    copy.time_ns = monotonic_ns();
    if constexpr (requires { copy.seq; }) copy.seq = seq_;
    if constexpr (requires { copy.client; }) copy.client = client_;
    if constexpr (requires { copy.controller; }) copy.controller = controller;
    if (!port_.publish(channel, copy)) throw ConfigError("the message could not be sent");
  };
  std::visit(Overloaded{
                 [&](const mode_request_t& m) { publish(channels::kModeRequest, m); },
                 [&](const compliance_goal_t& m) { publish(channels::kComplianceGoal, m); },
                 [&](const compliance_gains_t& m) { publish(channels::kComplianceGains, m); },
                 [&](const target_stream_t& m) { publish(channels::kTargetStream, m); },
                 [&](const hand_goal_t& m) { publish(channels::kHandGoal, m); },
                 [&](const push_t& m) { publish(channels::kPush, m); },
                 [&](const scenario_event_t& m) { publish(channels::kScenarioEvent, m); },
             },
             message);
}

}  // namespace limber
