// The soak works, is the same every time, and sees what it is there to see.
#include <gtest/gtest.h>

#include <string>

#include "qa/soak/soak.h"
#include "qa/soak/soak_report.h"
#include "tests/support/source_path.h"

namespace limber::test_soak {
namespace {

const LoadedRobot& planar2r() {
  static const LoadedRobot robot = load_robot(source_path("robots/planar2r"));
  return robot;
}

soak::SoakResult minutes(double arm_minutes, std::uint64_t seed, const LoadedRobot& robot) {
  soak::Soak soak(robot, seed);
  return soak.run(60.0 * arm_minutes, [] { return true; });
}

TEST(Soak, TwoMinutesOfRandomUseHaveNoTripWithoutACause) {
  const soak::SoakResult result = minutes(2.0, 3, planar2r());
  EXPECT_TRUE(result.violations.empty()) << result.violations.front();
  EXPECT_EQ(result.cycles, 120'000);
  for (const std::int64_t count : result.actions) EXPECT_GT(count, 0);
  EXPECT_GT(result.recoveries, 0);
}

TEST(Soak, TheSameSeedDoesTheSame) {
  const soak::SoakResult first = minutes(0.5, 5, planar2r());
  const soak::SoakResult second = minutes(0.5, 5, planar2r());
  EXPECT_EQ(first.actions, second.actions);
  EXPECT_EQ(first.trips, second.trips);
  EXPECT_NE(first.actions, minutes(0.5, 6, planar2r()).actions);
}

// Any law, gain and goal as fast as may be. These seeds swing soft springs up at their rate limit
// (baxter, antagonist2r), throw a joint back that is braked (openarm), and let a shoulder fall
// whose weight takes most of its torque at its end (desktop2r).
TEST(Soak, AcceptedRequestsCarryNoJointPastItsLimits) {
  struct Case {
    const char* robot;
    std::uint64_t seed;
    double arm_s;
  };
  for (const auto& [name, seed, arm_s] : {Case{"baxter", 1, 25.0},
                                          {"antagonist2r", 31, 6.0},
                                          {"openarm", 11, 103.0},
                                          {"desktop2r", 3, 552.0}}) {
    const LoadedRobot robot = load_robot(source_path("robots/") + name);
    soak::Soak soak(robot, seed, soak::Habit::kAnything);
    const soak::SoakResult result = soak.run(arm_s, [] { return true; });
    EXPECT_TRUE(result.violations.empty()) << name << ": " << result.violations.front();
    EXPECT_GT(result.cycles, 1000.0 * arm_s - 2.0) << name;
  }
}

// With these seeds one joint of yam stands, held by a hand, while a law and the other joints'
// motion load it: no stopped encoder.
TEST(Soak, APushedArmHasNoStoppedEncoder) {
  const LoadedRobot yam = load_robot(source_path("robots/yam"));
  for (const auto& [seed, arm_minutes] : {std::pair{1, 0.25}, {6, 0.8}}) {
    const soak::SoakResult result = minutes(arm_minutes, static_cast<std::uint64_t>(seed), yam);
    EXPECT_TRUE(result.violations.empty()) << seed << ": " << result.violations.front();
  }
}

// An arm whose speed limit any goal exceeds trips without a fault: the soak must say so.
TEST(Soak, ATripThatNobodyInjectedIsAViolation) {
  LoadedRobot slow = planar2r();
  for (JointConfig& joint : slow.robot.joints) joint.velocity_limit = 1e-3;
  const soak::SoakResult result = minutes(2.0, 3, slow);
  ASSERT_EQ(result.violations.size(), 1U);
  EXPECT_NE(result.violations[0].find("without a cause"), std::string::npos)
      << result.violations[0];
}

TEST(Soak, StopsWhenItIsTold) {
  soak::Soak soak(planar2r(), 1);
  int asked = 0;
  soak.run(3600.0, [&] { return ++asked < 3; });
  EXPECT_EQ(soak.result().cycles, 3000);
}

}  // namespace
}  // namespace limber::test_soak
