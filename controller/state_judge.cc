#include "controller/state_judge.h"

#include <algorithm>
#include <cmath>

#include "common/joints.h"

namespace limber::controller {
namespace {

constexpr std::int64_t kShortestPeriod_ns = 10'000;
constexpr std::int64_t kLongestPeriod_ns = 100'000'000;

bool usable(const joint_state_t& state, int joints) noexcept {
  if (state.num_joints != joints || joints > kMaxJoints || state.time_ns < 0) return false;
  if (state.period_ns < kShortestPeriod_ns || state.period_ns > kLongestPeriod_ns) return false;
  if (state.drive_state < joint_state_t::DRIVE_CONFIGURING ||
      state.drive_state > joint_state_t::DRIVE_FAULT) {
    return false;
  }
  for (const double* values :
       {state.q, state.v, state.theta, state.theta_dot, state.tau, state.tau_applied}) {
    if (!std::all_of(values, values + joints, [](double x) { return std::isfinite(x); })) {
      return false;
    }
  }
  return true;
}

}  // namespace

StateJudgement StateJudge::judge(const joint_state_t& state) noexcept {
  StateJudgement judgement;
  if (state.session == 0 || state.seq < 0) return judgement;
  if (state.session == session_ && state.seq <= seq_) {
    judgement.repeated = true;
    return judgement;
  }
  judgement.first = session_ == 0;
  judgement.new_session = !judgement.first && state.session != session_;
  if (state.session == session_) judgement.missed = state.seq - seq_ - 1;
  session_ = state.session;
  seq_ = state.seq;
  ++received_;
  lost_ += judgement.missed;

  judgement.usable = usable(state, joints_);
  if (!judgement.usable) return judgement;
  judgement.fresh = true;
  judgement.silent = judgement.missed > bridged_;
  for (int i = 0; i < joints_; ++i) {
    if ((state.joint_flags[i] & joint_state_t::JOINT_FRESH) == 0) judgement.fresh = false;
    if (!(state.age_cycles[i] <= bridged_)) judgement.silent = true;
  }
  return judgement;
}

}  // namespace limber::controller
