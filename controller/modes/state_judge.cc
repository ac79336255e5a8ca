#include "controller/modes/state_judge.h"

#include <algorithm>
#include <cmath>

namespace limber::controller {
namespace {

constexpr std::int64_t kShortestPeriod_ns = 10'000;
constexpr std::int64_t kLongestPeriod_ns = 100'000'000;

bool usable(const joint_state_t& state, int joints, int driven, const JointFlags& flags) noexcept {
  if (state.num_joints != joints || state.time_ns < 0) return false;
  if (state.period_ns < kShortestPeriod_ns || state.period_ns > kLongestPeriod_ns) return false;
  if (state.drive_state < joint_state_t::DRIVE_CONFIGURING ||
      state.drive_state > joint_state_t::DRIVE_FAULT) {
    return false;
  }
  if (state.emergency_stop < joint_state_t::STOP_NONE ||
      state.emergency_stop > joint_state_t::STOP_SILENT)
    return false;
  for (const double* values :
       {state.q, state.v, state.theta, state.theta_dot, state.tau, state.tau_applied}) {
    if (!std::all_of(values, values + driven, [](double x) { return std::isfinite(x); })) {
      return false;
    }
  }
  for (int i = 0; i < driven; ++i) {
    if (!(std::isfinite(state.preload[i]) && std::isfinite(state.preload_dot[i]) &&
          std::isfinite(state.tau_preload_applied[i])))
      return false;
    if ((state.joint_flags[i] & kEquipment) != flags[static_cast<std::size_t>(i)]) return false;
  }
  return true;
}

}  // namespace

JointFlags equipment_of(const Robot& robot) {
  JointFlags flags{};
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const JointConfig& joint = robot.joints[i];
    if (joint.link_encoder.present) flags[i] |= joint_state_t::JOINT_LINK_ENCODER;
    if (joint.torque_sensor.present) flags[i] |= joint_state_t::JOINT_TORQUE_SENSOR;
    if (joint.has_antagonist) flags[i] |= joint_state_t::JOINT_TWO_MOTORS;
  }
  if (robot.hand) flags[robot.joints.size()] = joint_state_t::JOINT_HAND;
  return flags;
}

bool StateJudge::goes_on_from_doubted(std::int64_t seq) const noexcept {
  return doubted_seq_ && seq > *doubted_seq_ && seq - *doubted_seq_ <= kMostMissed;
}

bool StateJudge::is_doubtful(const joint_state_t& state) noexcept {
  if (session_ == 0 || state.session == session_) {
    other_.reset();
    return false;
  }
  const bool goes_on = other_ && other_->session == state.session && state.seq >= other_->seq &&
                       state.seq - other_->seq <= kMostMissed;
  doubted_ += goes_on ? -1 : 1;
  other_ = Other{state.session, state.seq};
  return !goes_on;
}

StateJudgement StateJudge::judge(const joint_state_t& state) noexcept {
  StateJudgement judgement;
  if (state.session == 0 || state.seq < 0) return judgement;
  if (state.session == session_ && state.seq <= seq_) {
    judgement.repeated = true;
    return judgement;
  }
  judgement.doubted = is_doubtful(state);
  if (judgement.doubted) return judgement;
  const bool known = state.session == session_ && seq_ >= 0;
  const std::int64_t missed = known ? state.seq - seq_ - 1 : 0;
  if (missed >= kMostMissed && !goes_on_from_doubted(state.seq)) {
    doubted_seq_ = state.seq;
    return judgement;
  }
  judgement.first = session_ == 0;
  judgement.new_session = !judgement.first && state.session != session_;
  judgement.missed = std::min(missed, kMostMissed);
  session_ = state.session;
  seq_ = state.seq;
  doubted_seq_.reset();
  ++received_;
  lost_ += judgement.missed;

  judgement.usable = usable(state, joints_, driven_, flags_);
  if (!judgement.usable) return judgement;
  judgement.fresh = true;
  judgement.silent = judgement.missed > bridged_;
  for (int i = 0; i < driven_; ++i) {
    if ((state.joint_flags[i] & joint_state_t::JOINT_FRESH) == 0) judgement.fresh = false;
    if (!(state.age_cycles[i] <= bridged_)) judgement.silent = true;
  }
  return judgement;
}

}  // namespace limber::controller
