#include "controller/controller_process.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <limits>

#include "common/clock.h"
#include "common/pace_text.h"
#include "common/tell.h"
#include "lcmtypes/channels.h"

namespace limber {
namespace {

// Then the next state is looked for: no flood of requests keeps it waiting.
constexpr int kRequestsAtOnce = 2;
// Without states requests are looked for so often.
constexpr std::int64_t kRequestWait_ns = 5'000'000;

RealtimeGrant request_realtime(const ControllerProcessOptions& options) {
  if (options.priority == 0) return {};
  if (in_lockstep(options.pace)) return {.reason = raise_priority(options.pace == Pace::kPaced)};
  RealtimeGrant grant = ask_for_realtime(options.priority);
  if (!grant.reason.empty()) spdlog::warn("not real-time: {}; cycles may be late", grant.reason);
  return grant;
}

}  // namespace

ControllerProcess::ControllerProcess(ArmController* controller,
                                     const ControllerProcessOptions& options)
    : controller_(controller),
      options_(options),
      black_box_(open_black_box("controller-" + options.robot, options.rate_hz, options.pace)),
      log_(options.joints, black_box_.get()),
      user_(user_plane_url()),
      desk_(controller, &user_),
      grant_(request_realtime(options)),
      arm_(arm_plane_url(), ArmPlaneEnd::kController) {
  arm_.subscribe<joint_state_t>(channels::kJointState,
                                [this](const joint_state_t& state) { on_state(state); });
  arm_.set_black_box(black_box_.get());
  user_.set_black_box(black_box_.get());
  require_local(user_plane_url(), options.moves_motors);
  require_local(arm_plane_url(), options.moves_motors);
}

void ControllerProcess::run(const volatile std::sig_atomic_t& stop) noexcept {
  const std::int64_t end_ns =
      options_.duration_s > 0.0
          ? monotonic_ns() + static_cast<std::int64_t>(options_.duration_s * 1e9)
          : std::numeric_limits<std::int64_t>::max();
  last_state_ns_ = monotonic_ns();
  while (stop == 0 && monotonic_ns() < end_ns) {
    const std::int64_t until_ns = monotonic_ns() + kRequestWait_ns;
    arm_.wait(until_ns);
    const std::int64_t stall_ns = monotonic_ns() - until_ns;
    handle_waiting();
    if (in_lockstep(options_.pace)) continue;
    if (stall_ns > kStall_ns)
      spdlog::warn("warning: {}", stall_text("limber-controller", stall_ns));
    check_silence();
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
  if (in_lockstep(options_.pace)) {
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
  silence_ns_ = std::clamp(3 * state.period_ns, kSilence_ns, 3 * kSilence_ns);
  answered_seq_ = torque.state_seq;
  answered_session_ = torque.session;
  user_.publish(channels::kJointTorque, torque);
  if (torque.state_seq % channels::kControllerStatusEvery == 0) publish_status();
  if (torque.state_seq % channels::kRobotInfoEvery == 0)
    user_.publish(channels::kRobotInfo, controller_->robot_info());
  for (const RequestOutcome& outcome : controller_->timeline_outcomes())
    desk_.answer(outcome, state.time_ns);
  tell([&] { log_.note(controller_->status(), state); });
}

void ControllerProcess::publish_status() noexcept {
  controller_->count_undecodable(arm_.undecodable() + user_.undecodable());
  user_.publish(channels::kControllerStatus, controller_->status());
  if (controller_->hand_state() != nullptr)
    user_.publish(channels::kHandState, *controller_->hand_state());
}

void ControllerProcess::check_silence() noexcept {
  const std::int64_t now_ns = monotonic_ns();
  if (now_ns - last_state_ns_ < silence_ns_) return;
  last_state_ns_ = now_ns;
  controller_->on_silence();
  publish_status();
  log_.note(controller_->status(), joint_state_t::FAULT_NONE);
}

}  // namespace limber
