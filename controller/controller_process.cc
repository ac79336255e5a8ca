#include "controller/controller_process.h"

#include <spdlog/spdlog.h>

#include <limits>

#include "common/clock.h"
#include "lcmtypes/channels.h"

namespace limber {
namespace {

// Lock step keeps everything, realtime only needs the newest; the rest is counted as lost.
constexpr int kRequestQueue = 32;
// Then the next state is looked for: no flood of requests keeps it waiting.
constexpr int kRequestsAtOnce = 2;
// Without states requests are looked for so often.
constexpr std::int64_t kRequestWait_ns = 5'000'000;
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

bool is_stop(const mode_request_t& request) noexcept {
  return request.request == mode_request_t::REQUEST_STOP;
}
template <typename Request>
bool is_stop(const Request&) noexcept {
  return false;
}

RealtimeGrant request_realtime(const ControllerProcessOptions& options) {
  if (options.lockstep || options.priority == 0) return {};
  RealtimeGrant grant = ask_for_realtime(options.priority);
  if (!grant.reason.empty()) spdlog::warn("not real-time: {}; cycles may be late", grant.reason);
  return grant;
}

}  // namespace

ControllerProcess::ControllerProcess(ArmController* controller,
                                     const ControllerProcessOptions& options)
    : controller_(controller),
      guard_(controller->status().controller),
      options_(options),
      black_box_(open_black_box("controller-" + options.robot, options.rate_hz, options.lockstep)),
      log_(options.joints, black_box_.get()),
      user_(user_plane_url()),
      grant_(request_realtime(options)),
      arm_(arm_plane_url(), ArmPlaneEnd::kController) {
  arm_.subscribe<joint_state_t>(channels::kJointState,
                                [this](const joint_state_t& state) { on_state(state); });
  arm_.set_black_box(black_box_.get());
  user_.set_black_box(black_box_.get());
  require_local(user_plane_url(), options.moves_motors);
  require_local(arm_plane_url(), options.moves_motors);
  subscribe<mode_request_t>(channels::kModeRequest);
  subscribe<compliance_goal_t>(channels::kComplianceGoal);
  subscribe<compliance_gains_t>(channels::kComplianceGains);
}

template <typename Request>
void ControllerProcess::subscribe(const char* channel) {
  user_.subscribe<Request>(channel, kRequestQueue,
                           [this](const Request& request) { take(request); });
}

void ControllerProcess::run(const volatile std::sig_atomic_t& stop) noexcept {
  const std::int64_t end_ns =
      options_.duration_s > 0.0
          ? monotonic_ns() + static_cast<std::int64_t>(options_.duration_s * 1e9)
          : std::numeric_limits<std::int64_t>::max();
  last_state_ns_ = monotonic_ns();
  while (stop == 0 && monotonic_ns() < end_ns) {
    arm_.wait(monotonic_ns() + kRequestWait_ns);
    handle_waiting();
    if (!options_.lockstep) check_silence();
  }
}

void ControllerProcess::handle_waiting() noexcept {
  arm_.handle_waiting();
  if (waiting_) answer(newest_);
  waiting_ = false;
  // After the answer: users wait for the arm, not the other way round.
  user_.handle_waiting(kRequestsAtOnce);
}

void ControllerProcess::on_state(const joint_state_t& state) noexcept {
  if (options_.lockstep) {
    answer(state);
  } else {
    newest_ = state;
    waiting_ = true;
  }
}

void ControllerProcess::answer(const joint_state_t& state) noexcept {
  const joint_command_t& torque = controller_->step(state);
  arm_.publish(channels::kJointTorque, torque);
  if (torque.state_seq == answered_seq_ && torque.session == answered_session_) return;
  last_state_ns_ = monotonic_ns();
  answered_seq_ = torque.state_seq;
  answered_session_ = torque.session;
  user_.publish(channels::kJointTorque, torque);
  if (torque.state_seq % channels::kControllerStatusEvery == 0) publish_status();
  if (torque.state_seq % channels::kRobotInfoEvery == 0)
    user_.publish(channels::kRobotInfo, controller_->robot_info());
  for (const RequestOutcome& outcome : controller_->timeline_outcomes())
    publish_answer(outcome, state.time_ns);
  log_.note(controller_->status(), state.fault);
}

void ControllerProcess::publish_status() noexcept {
  controller_->count_undecodable(arm_.undecodable() + user_.undecodable());
  user_.publish(channels::kControllerStatus, controller_->status());
}

void ControllerProcess::check_silence() noexcept {
  const std::int64_t now_ns = monotonic_ns();
  if (now_ns - last_state_ns_ < kSilence_ns) return;
  last_state_ns_ = now_ns;
  controller_->on_silence();
  publish_status();
  log_.note(controller_->status(), joint_state_t::FAULT_NONE);
}

template <typename Request>
Refusal ControllerProcess::judge(const Request& request) noexcept {
  if (!is_stop(request)) {
    const Refusal refusal = guard_.check(request.controller, request.client, request.seq);
    if (refusal) {
      controller_->count_refusal();
      return refusal;
    }
  }
  return decide(controller_, request);
}

template <typename Request>
void ControllerProcess::take(const Request& request) noexcept {
  publish_answer(outcome_of(request, judge(request)), controller_->status().time_ns);
}

void ControllerProcess::publish_answer(const RequestOutcome& outcome,
                                       std::int64_t time_ns) noexcept {
  const request_answer_t answer = answer_to(outcome, time_ns);
  user_.publish(channels::kRequestAnswer, answer);
  const std::int64_t now_ns = monotonic_ns();
  const bool worth_a_line = outcome.refusal || outcome.refusal.warning != nullptr;
  if (!worth_a_line || now_ns - logged_ns_ < kLogInterval_ns) return;  // all are in the status
  logged_ns_ = now_ns;
  ControllerLog::note(answer);
}

}  // namespace limber
