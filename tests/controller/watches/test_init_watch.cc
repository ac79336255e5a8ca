#include <gtest/gtest.h>

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
