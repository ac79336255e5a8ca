#include "controller/controller_process.h"

#include <spdlog/spdlog.h>

#include <array>
#include <limber/request_answer_t.hpp>
#include <limits>

#include "common/clock.h"
#include "lcmtypes/channels.h"

namespace limber {
namespace {

// Lock step keeps everything, realtime only needs the newest; the rest is counted as lost.
constexpr int kStateQueue = 64;
constexpr int kRequestQueue = 32;
constexpr std::int64_t kLogInterval_ns = 200'000'000;

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
      options_(options),
      // LCM starts a thread for each plane. The user plane's, which anybody may flood, keeps normal
      // priority; the arm plane's inherits ours.
      user_(user_plane_url()),
      grant_(request_realtime(options)),
      arm_(arm_plane_url()) {
  arm_.subscribe<joint_state_t>(channels::kJointState, kStateQueue,
                                [this](const joint_state_t& state) { on_state(state); });
  user_.subscribe<mode_request_t>(
      channels::kModeRequest, kRequestQueue, [this](const mode_request_t& request) {
        reply(request, "mode request refused", controller_->on_mode(request));
      });
  user_.subscribe<compliance_goal_t>(channels::kComplianceGoal, kRequestQueue,
                                     [this](const compliance_goal_t& goal) {
                                       reply(goal, "goal refused", controller_->on_goal(goal));
                                     });
  user_.subscribe<compliance_gains_t>(channels::kComplianceGains, kRequestQueue,
                                      [this](const compliance_gains_t& gains) {
                                        reply(gains, "gains refused", controller_->on_gains(gains));
                                      });
}

void ControllerProcess::run(const volatile std::sig_atomic_t& stop) noexcept {
  const std::int64_t end_ns =
      options_.duration_s > 0.0
          ? monotonic_ns() + static_cast<std::int64_t>(options_.duration_s * 1e9)
          : std::numeric_limits<std::int64_t>::max();
  last_state_ns_ = monotonic_ns();
  const std::array descriptors{arm_.descriptor(), user_.descriptor()};
  while (stop == 0 && monotonic_ns() < end_ns) {
    wait_readable(descriptors, monotonic_ns() + kSilence_ns);
    handle_waiting();
    if (!options_.lockstep) check_silence();
  }
}

void ControllerProcess::handle_waiting() noexcept {
  arm_.handle_waiting();
  if (waiting_) answer(newest_);
  waiting_ = false;
  user_.handle_waiting();  // after the answer: users wait for the arm, not the other way round
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
  last_state_ns_ = monotonic_ns();
  const joint_command_t& torque = controller_->step(state);
  arm_.publish(channels::kJointTorque, torque);
  if (torque.state_seq == answered_seq_ && torque.session == answered_session_) return;
  answered_seq_ = torque.state_seq;
  answered_session_ = torque.session;
  user_.publish(channels::kJointTorque, torque);
  if (torque.state_seq % channels::kControllerStatusEvery == 0) {
    user_.publish(channels::kControllerStatus, controller_->status());
  }
}

void ControllerProcess::check_silence() noexcept {
  const std::int64_t now_ns = monotonic_ns();
  if (now_ns - last_state_ns_ < kSilence_ns) return;
  last_state_ns_ = now_ns;
  controller_->on_silence();
  user_.publish(channels::kControllerStatus, controller_->status());
}

template <typename Request>
void ControllerProcess::reply(const Request& request, const char* what,
                              const char* reason) noexcept {
  request_answer_t answer;
  answer.time_ns = controller_->status().time_ns;
  answer.client = request.client;
  answer.seq = request.seq;
  answer.accepted = reason == nullptr ? 1 : 0;
  answer.reason = reason == nullptr ? "" : reason;
  user_.publish(channels::kRequestAnswer, answer);
  log_refusal(what, reason);
}

void ControllerProcess::log_refusal(const char* what, const char* reason) noexcept {
  if (reason == nullptr) return;
  const std::int64_t now_ns = monotonic_ns();
  if (now_ns - logged_ns_ < kLogInterval_ns) return;  // all are counted in the status
  logged_ns_ = now_ns;
  spdlog::warn("{}: {}", what, reason);
}

}  // namespace limber
