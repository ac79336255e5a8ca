// What makes a JOINT_STATE unusable, stale or silent: each field by itself, at its boundary.
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <vector>

#include "controller/modes/state_judge.h"

namespace limber::controller::test_state_judge {
namespace {

constexpr int kJoints = 2;
constexpr int kBridged = 2;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

joint_state_t good_state(std::int64_t seq = 0) {
  joint_state_t state{};
  state.seq = seq;
  state.session = 5;
  state.period_ns = 1'000'000;
  state.num_joints = kJoints;
  state.drive_state = joint_state_t::DRIVE_ON;
  for (int i = 0; i < kJoints; ++i) state.joint_flags[i] = joint_state_t::JOINT_FRESH;
  return state;
}

/// The judgement of a first state that differs from a good one.
StateJudgement judged(const std::function<void(joint_state_t&)>& change) {
  joint_state_t state = good_state();
  change(state);
  return StateJudge(kJoints, kBridged).judge(state);
}
bool usable(const std::function<void(joint_state_t&)>& change) { return judged(change).usable; }

TEST(StateJudgeFields, TheFirstGoodStateIsAllItShallBe) {
  StateJudge judge(kJoints, kBridged);
  EXPECT_EQ(judge.received(), 0);
  const StateJudgement first = judge.judge(good_state());
  EXPECT_TRUE(first.first && first.usable && first.fresh);
  EXPECT_FALSE(first.repeated || first.new_session || first.silent);
  EXPECT_EQ(first.missed, 0);
  EXPECT_EQ(judge.received(), 1);
  EXPECT_EQ(judge.lost(), 0);
  EXPECT_FALSE(judge.judge(good_state(1)).first);
}

// The hand is the entry after the joints: its answers count, for an arm that has one.
TEST(StateJudgeFields, AHandIsJudgedAfterTheJoints) {
  Robot robot;
  robot.joints.resize(kJoints);
  robot.hand.emplace();
  const JointFlags flags = equipment_of(robot);
  EXPECT_EQ(flags[kJoints], +joint_state_t::JOINT_HAND);
  joint_state_t state = good_state();
  state.joint_flags[kJoints] = +joint_state_t::JOINT_HAND | +joint_state_t::JOINT_FRESH;
  EXPECT_TRUE(StateJudge(kJoints, kBridged, flags).judge(state).fresh);
  state.age_cycles[kJoints] = kBridged + 1;
  EXPECT_TRUE(StateJudge(kJoints, kBridged, flags).judge(state).silent);
  EXPECT_FALSE(StateJudge(kJoints, kBridged).judge(good_state()).silent);
  state.age_cycles[kJoints] = 0;
  state.age_cycles[kJoints + 1] = kBridged + 1;  // there is nothing
  EXPECT_FALSE(StateJudge(kJoints, kBridged, flags).judge(state).silent);
  // Sixteen joints, fifteen and a hand.
  JointFlags all{};
  all[kMaxJoints - 1] = joint_state_t::JOINT_HAND;
  joint_state_t full{};
  full.session = 5;
  full.period_ns = 1'000'000;
  full.num_joints = kMaxJoints - 1;
  for (int i = 0; i < kMaxJoints; ++i) full.joint_flags[i] = joint_state_t::JOINT_FRESH;
  full.joint_flags[kMaxJoints - 1] |= joint_state_t::JOINT_HAND;
  full.age_cycles[kMaxJoints - 1] = kBridged + 1;
  EXPECT_TRUE(StateJudge(kMaxJoints - 1, kBridged, all).judge(full).silent);
}

TEST(StateJudgeFields, WithoutASessionOrANumberItIsNoState) {
  for (const auto& [session, seq] :
       std::vector<std::pair<std::int64_t, std::int64_t>>{{0, 0}, {5, -1}}) {
    StateJudge judge(kJoints, kBridged);
    joint_state_t state = good_state(seq);
    state.session = session;
    const StateJudgement judgement = judge.judge(state);
    EXPECT_FALSE(judgement.usable || judgement.first || judgement.repeated || judgement.fresh);
    EXPECT_FALSE(judgement.new_session || judgement.silent);
    EXPECT_EQ(judge.received(), 0);
  }
}

TEST(StateJudgeFields, ThisArmsJoints) {
  EXPECT_FALSE(usable([](auto& state) { state.num_joints = kJoints - 1; }));
  EXPECT_FALSE(usable([](auto& state) { state.num_joints = kJoints + 1; }));
  joint_state_t state = good_state();
  state.num_joints = kMaxJoints;
  EXPECT_TRUE(StateJudge(kMaxJoints, kBridged).judge(state).usable);
}

TEST(StateJudgeFields, TimeAndPeriod) {
  EXPECT_TRUE(usable([](auto& state) { state.time_ns = 0; }));
  EXPECT_FALSE(usable([](auto& state) { state.time_ns = -1; }));
  for (std::int64_t good_ns : {10'000, 100'000'000})
    EXPECT_TRUE(usable([=](auto& state) { state.period_ns = good_ns; })) << good_ns;
  for (std::int64_t bad_ns : {-1, 0, 9'999, 100'000'001})
    EXPECT_FALSE(usable([=](auto& state) { state.period_ns = bad_ns; })) << bad_ns;
}

TEST(StateJudgeFields, TheDriveStateIsOneOfSeven) {
  for (int drive_state = -128; drive_state < 128; ++drive_state) {
    const bool known = drive_state >= 0 && drive_state < 7;
    EXPECT_EQ(usable([=](auto& s) { s.drive_state = static_cast<std::int8_t>(drive_state); }),
              known)
        << drive_state;
  }
}

TEST(StateJudgeFields, TheEmergencyStopIsOneOfFour) {
  for (int stop = -128; stop < 128; ++stop) {
    const bool known = stop >= 0 && stop < 4;
    EXPECT_EQ(usable([=](auto& s) { s.emergency_stop = static_cast<std::int8_t>(stop); }), known)
        << stop;
  }
}

void set(joint_state_t* state, int field, int joint, double value) {
  double* const numbers[] = {state->q,         state->v,   state->theta,
                             state->theta_dot, state->tau, state->tau_applied};
  float* const short_numbers[] = {state->preload, state->preload_dot, state->tau_preload_applied};
  if (field < 6) {
    numbers[field][joint] = value;
  } else {
    short_numbers[field - 6][joint] = static_cast<float>(value);
  }
}

TEST(StateJudgeFields, EveryNumberOfEveryJointIsFinite) {
  for (int field = 0; field < 9; ++field) {
    for (int joint = 0; joint < kJoints; ++joint) {
      for (double bad : {kNan, kInf, -kInf})
        EXPECT_FALSE(usable([=](auto& state) { set(&state, field, joint, bad); }))
            << field << " of joint " << joint;
    }
    EXPECT_TRUE(usable([=](auto& state) { set(&state, field, kJoints, kNan); })) << field;
  }
}

TEST(StateJudgeFields, AnotherArmsEquipmentIsRefused) {
  Robot robot;
  robot.joints.resize(4);
  robot.joints[0].link_encoder.present = true;
  robot.joints[1].torque_sensor.present = true;
  robot.joints[2].has_antagonist = true;
  const JointFlags flags = equipment_of(robot);
  const std::int32_t bits[] = {joint_state_t::JOINT_LINK_ENCODER,
                               joint_state_t::JOINT_TORQUE_SENSOR, joint_state_t::JOINT_TWO_MOTORS,
                               0};
  joint_state_t state = good_state();
  state.num_joints = 4;
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(flags[static_cast<std::size_t>(i)], bits[i]);
    state.joint_flags[i] = bits[i] | joint_state_t::JOINT_FRESH | joint_state_t::JOINT_ENABLED;
  }
  EXPECT_TRUE(StateJudge(4, kBridged, flags).judge(state).usable);
  for (int joint = 0; joint < 4; ++joint) {
    for (int other = 0; other < 3; ++other) {
      joint_state_t wrong = state;
      wrong.joint_flags[joint] ^= bits[other];
      EXPECT_FALSE(StateJudge(4, kBridged, flags).judge(wrong).usable) << joint << " " << other;
    }
  }
}

TEST(StateJudgeFields, FreshIfEveryJointHasAnsweredNow) {
  for (int joint = 0; joint < kJoints; ++joint) {
    const StateJudgement judgement = judged([=](auto& state) { state.joint_flags[joint] = 0; });
    EXPECT_TRUE(judgement.usable && !judgement.fresh);
  }
  const StateJudgement unusable = judged([](auto& state) { state.q[0] = kNan; });
  EXPECT_FALSE(unusable.fresh || unusable.silent);
}

TEST(StateJudgeFields, AJointIsSilentAfterTheBridgedCycles) {
  for (int joint = 0; joint < kJoints; ++joint) {
    EXPECT_FALSE(judged([=](auto& state) { state.age_cycles[joint] = kBridged; }).silent);
    EXPECT_TRUE(judged([=](auto& state) { state.age_cycles[joint] = kBridged + 1; }).silent);
  }
}

TEST(StateJudgeFields, TheStreamIsSilentAfterTheBridgedCycles) {
  for (int missed = 0; missed <= kBridged + 1; ++missed) {
    StateJudge judge(kJoints, kBridged);
    judge.judge(good_state(0));
    const StateJudgement judgement = judge.judge(good_state(1 + missed));
    EXPECT_EQ(judgement.missed, missed);
    EXPECT_EQ(judgement.silent, missed > kBridged) << missed;
    EXPECT_EQ(judge.lost(), missed);
  }
}

}  // namespace
}  // namespace limber::controller::test_state_judge
