#include "controller/request_desk.h"

#include <type_traits>

#include "common/clock.h"
#include "common/tell.h"
#include "controller/client_life.h"
#include "controller/controller_log.h"
#include "lcmtypes/channels.h"

namespace limber {
namespace {

// So many wait while the process is busy; the rest is counted as lost.
constexpr int kRequestQueue = 32;
constexpr int kStreamQueue = 8;
constexpr std::int64_t kLogInterval_ns = 200'000'000;

Refusal decide(ArmController* controller, const mode_request_t& request) noexcept {
  return controller->on_mode(request);
}
Refusal decide(ArmController* controller, const compliance_goal_t& goal) noexcept {
  return controller->on_goal(goal);
}
Refusal decide(ArmController* controller, const compliance_gains_t& gains) noexcept {
  return controller->on_gains(gains);
}
Refusal decide(ArmController* controller, const hand_goal_t& goal) noexcept {
  return controller->on_hand(goal);
}
Refusal decide(ArmController* controller, const target_stream_t& stream) noexcept {
  return controller->on_stream(stream);
}
Refusal decide(ArmController* controller, const torque_overlay_t& overlay) noexcept {
  return controller->on_overlay(overlay);
}

// Many a second: only refusals are worth an answer.
template <typename Request>
constexpr bool kStreamed =
    std::is_same_v<Request, target_stream_t> || std::is_same_v<Request, torque_overlay_t>;

bool is_stop(const mode_request_t& request) noexcept {
  return request.request == mode_request_t::REQUEST_STOP;
}
template <typename Request>
bool is_stop(const Request&) noexcept {
  return false;
}

}  // namespace

RequestDesk::RequestDesk(ArmController* controller, LcmPort* user)
    : controller_(controller), user_(user), guard_(controller->status().controller) {
  subscribe<mode_request_t>(channels::kModeRequest);
  subscribe<compliance_goal_t>(channels::kComplianceGoal);
  subscribe<compliance_gains_t>(channels::kComplianceGains);
  subscribe<target_stream_t>(channels::kTargetStream);
  subscribe<torque_overlay_t>(channels::kTorqueOverlay);
  subscribe<hand_goal_t>(channels::kHandGoal);
}

template <typename Request>
void RequestDesk::subscribe(const char* channel) {
  const int queue = kStreamed<Request> ? kStreamQueue : kRequestQueue;
  user_->subscribe<Request>(channel, queue, [this](const Request& request) {
    const RequestOutcome outcome = outcome_of(request, judge(request));
    if (kStreamed<Request> && !worth_an_answer(outcome)) return;
    answer(outcome, controller_->status().time_ns);
  });
}

template <typename Request>
Refusal RequestDesk::judge(const Request& request) noexcept {
  if (!is_stop(request)) {
    const Refusal refusal = guard_.check(request.controller, request.client, request.seq);
    if constexpr (std::is_same_v<Request, target_stream_t>) {
      if (refusal.code == request_answer_t::REFUSED_REPEATED) {
        controller_->count_stale_stream();
        return {};
      }
    }
    if (refusal) {
      controller_->count_refusal();
      return refusal;
    }
  }
  if (const std::int64_t lease = controller_->lease();
      request.client != lease && client_gone(lease))
    controller_->free_lease();
  return decide(controller_, request);
}

bool RequestDesk::worth_an_answer(const RequestOutcome& outcome) noexcept {
  if (!outcome.refusal) return false;
  const std::int64_t now_ns = monotonic_ns();
  if (now_ns - refused_ns_ < kLogInterval_ns) return false;
  refused_ns_ = now_ns;
  return true;
}

void RequestDesk::answer(const RequestOutcome& outcome, std::int64_t time_ns) noexcept {
  tell([&] {
    const request_answer_t answer = answer_to(outcome, time_ns);
    user_->publish(channels::kRequestAnswer, answer);
    const std::int64_t now_ns = monotonic_ns();
    const bool worth_a_line = outcome.refusal || outcome.refusal.warning != nullptr;
    if (!worth_a_line || now_ns - logged_ns_ < kLogInterval_ns) return;  // all are in the status
    logged_ns_ = now_ns;
    ControllerLog::note(answer);
  });
}

}  // namespace limber
