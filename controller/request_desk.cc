#include "controller/request_desk.h"

#include "common/clock.h"
#include "common/tell.h"
#include "controller/controller_log.h"
#include "lcmtypes/channels.h"

namespace limber {
namespace {

// So many wait while the process is busy; the rest is counted as lost.
constexpr int kRequestQueue = 32;
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
  subscribe<hand_goal_t>(channels::kHandGoal);
}

template <typename Request>
void RequestDesk::subscribe(const char* channel) {
  user_->subscribe<Request>(channel, kRequestQueue, [this](const Request& request) {
    answer(outcome_of(request, judge(request)), controller_->status().time_ns);
  });
}

template <typename Request>
Refusal RequestDesk::judge(const Request& request) noexcept {
  if (!is_stop(request)) {
    const Refusal refusal = guard_.check(request.controller, request.client, request.seq);
    if (refusal) {
      controller_->count_refusal();
      return refusal;
    }
  }
  return decide(controller_, request);
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
