#include <gtest/gtest.h>

#include <initializer_list>

#include "controller/watches/init_watch.h"

namespace limber::test_init_watch {
namespace {

constexpr std::int8_t kInit = controller_status_t::MODE_INIT;

/// Two joints at 1 kHz, the second late in every `late_every`-th cycle; what is told in `cycles`.
struct Bench {
  InitWatch watch;
  std::int64_t k = 0;

  std::optional<InitWatch::Finding> run(int cycles, int late_every, std::int8_t mode = kInit,
                                        std::int8_t drives = joint_state_t::DRIVE_OFF) {
    std::optional<InitWatch::Finding> told;
    for (int i = 0; i < cycles; ++i, ++k) {
      joint_state_t state{};
      state.time_ns = k * 1'000'000;
      state.num_joints = 2;
      state.drive_state = drives;
      state.joint_flags[0] = joint_state_t::JOINT_FRESH;
      state.joint_flags[1] = k % late_every == 0 ? 0 : +joint_state_t::JOINT_FRESH;
      if (const auto found = watch.note(mode, state)) {
        EXPECT_FALSE(told) << "once";
        told = found;
      }
    }
    return told;
  }
};

TEST(InitWatch, NamesTheJointThatIsLateAndHowOften) {
  Bench bench;
  EXPECT_FALSE(bench.run(2000, 14));
  const auto told = bench.run(3000, 14);
  ASSERT_TRUE(told);
  EXPECT_EQ(told->joint, 1);
  EXPECT_NEAR(told->share, 1.0 / 14.0, 0.001);
}

joint_state_t off_at(std::int64_t time_ns, int joints) {
  joint_state_t state{};
  state.time_ns = time_ns;
  state.num_joints = static_cast<std::int8_t>(joints);
  state.drive_state = joint_state_t::DRIVE_OFF;
  for (auto& flags : state.joint_flags) flags = joint_state_t::JOINT_FRESH;
  return state;
}

/// What is found two seconds after the first state, in each of which these joints are late.
InitWatch::Finding found(int joints, std::initializer_list<int> late) {
  InitWatch watch;
  std::optional<InitWatch::Finding> told;
  for (const std::int64_t time_ns : {std::int64_t{5}, 5 + InitWatch::kPatience_ns}) {
    joint_state_t state = off_at(time_ns, joints);
    for (const int joint : late) state.joint_flags[joint] = 0;
    told = watch.note(kInit, state);
  }
  EXPECT_TRUE(told);
  return told.value_or(InitWatch::Finding{-1, -1.0, 0.0});
}

TEST(InitWatch, NamesTheFirstOfThoseThatAreLateAlike) {
  EXPECT_EQ(found(2, {0}).joint, 0);
  EXPECT_EQ(found(2, {0, 1}).joint, 0);
  EXPECT_EQ(found(3, {1, 2}).joint, 1);
  EXPECT_EQ(found(16, {15}).joint, 15);
  EXPECT_EQ(found(16, {15}).share, 1.0);
}

// At 40 Hz the supervisor's hundred states alone take longer than two seconds.
TEST(InitWatch, HasPatienceForTwoHundredCycles) {
  InitWatch watch;
  joint_state_t state = off_at(0, 1);
  state.period_ns = 25'000'000;
  EXPECT_FALSE(watch.note(kInit, state));
  state.time_ns = 200 * state.period_ns - 1;
  EXPECT_FALSE(watch.note(kInit, state));
  ++state.time_ns;
  const auto told = watch.note(kInit, state);
  ASSERT_TRUE(told);
  EXPECT_NEAR(told->waited_s, 5.0, 1e-12);
}

TEST(InitWatch, CountsTheArmsJointsAlone) {
  EXPECT_EQ(found(2, {2, 15}).share, 0.0);
  EXPECT_EQ(found(2, {}).joint, 0);
}

TEST(InitWatch, HasPatienceForTwoSeconds) {
  InitWatch watch;
  EXPECT_FALSE(watch.note(kInit, off_at(7, 1)));
  EXPECT_FALSE(watch.note(kInit, off_at(6 + InitWatch::kPatience_ns, 1)));
  EXPECT_TRUE(watch.note(kInit, off_at(7 + InitWatch::kPatience_ns, 1)));
}

TEST(InitWatch, WaitsForDrivesThatAreStillBeingSetUp) {
  Bench bench;
  EXPECT_FALSE(bench.run(5000, 14, kInit, joint_state_t::DRIVE_CONFIGURING));
  EXPECT_FALSE(bench.run(1999, 14));
}

TEST(InitWatch, BeginsAnewWhenInitDoes) {
  Bench bench;
  EXPECT_FALSE(bench.run(1500, 14));
  EXPECT_FALSE(bench.run(1, 14, controller_status_t::MODE_IDLE));
  EXPECT_FALSE(bench.run(1500, 14));
  EXPECT_TRUE(bench.run(1000, 14));
}

}  // namespace
}  // namespace limber::test_init_watch
