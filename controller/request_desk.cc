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
  subscribe(channels::kModeRequest, &ArmController::on_mode);
  subscribe(channels::kComplianceGoal, &ArmController::on_goal);
  subscribe(channels::kComplianceGains, &ArmController::on_gains);
  subscribe(channels::kTargetStream, &ArmController::on_stream);
  subscribe(channels::kTorqueOverlay, &ArmController::on_overlay);
  subscribe(channels::kHandGoal, &ArmController::on_hand);
}

template <typename Request>
void RequestDesk::subscribe(const char* channel, Decide<Request> decide) {
  const int queue = kStreamed<Request> ? kStreamQueue : kRequestQueue;
  user_->subscribe<Request>(channel, queue, [this, decide](const Request& request) {
    const RequestOutcome outcome = outcome_of(request, judge(request, decide));
    if (kStreamed<Request> && !worth_an_answer(outcome)) return;
    answer(outcome, controller_->status().time_ns);
  });
}

template <typename Request>
Refusal RequestDesk::judge(const Request& request, Decide<Request> decide) noexcept {
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
  return (controller_->*decide)(request);
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
