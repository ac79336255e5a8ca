// A law whose torque lags behind for long lets go of springs.
#include <gtest/gtest.h>

#include <cmath>

#include "controller/output/rate_relief.h"

namespace limber::controller::test_rate_relief {
namespace {

constexpr double kT = 1e-3;

VectorJ two(double a, double b) { return VectorJ{{a, b}}; }

TEST(RateRelief, LeavesWhatIsNotLimitedAlone) {
  RateRelief relief;
  for (int k = 0; k < 1000; ++k) relief.note(k % 3 == 0, kT);  // a third of the time
  VectorJ tau = two(5.0, -3.0);
  EXPECT_FALSE(relief.apply(two(1.0, 1.0), &tau));
  EXPECT_EQ(tau, two(5.0, -3.0));
}

// m = 1 - exp(-t / 30 ms) is 1/2 after 20.8 ms; 50 ms later nothing of the law is left. The way
// back: m = exp(-t / 30 ms) is 1/2 after as long, and 0.5 s later all of it is there.
TEST(RateRelief, FadesWhatIsLimitedForLongAndReturnsSlowly) {
  RateRelief relief;
  int cycles = 0;
  for (; relief.share() == 1.0; ++cycles) relief.note(true, kT);
  EXPECT_NEAR(kT * cycles, RateRelief::kMemory_s * std::log(2.0), 1.5 * kT);
  for (cycles = 0; relief.share() > 0.0; ++cycles) relief.note(true, kT);
  EXPECT_NEAR(kT * cycles, RateRelief::kFades_s, 1.5 * kT);
  VectorJ tau = two(5.0, -3.0);
  EXPECT_TRUE(relief.apply(two(1.0, 2.0), &tau));
  EXPECT_EQ(tau, two(1.0, 2.0)) << "the weight is carried";
  for (cycles = 0; relief.share() < 1.0; ++cycles) relief.note(false, kT);
  EXPECT_GT(kT * cycles, RateRelief::kReturns_s);
  EXPECT_LT(kT * cycles, RateRelief::kReturns_s + 2.0 * RateRelief::kMemory_s);
}

TEST(RateRelief, HalfOfItInBetween) {
  RateRelief relief;
  while (relief.share() > 0.5) relief.note(true, kT);
  VectorJ tau = two(5.0, -3.0);
  EXPECT_TRUE(relief.apply(two(1.0, 1.0), &tau));
  EXPECT_NEAR(tau[0], 1.0 + relief.share() * 4.0, 1e-12);
  EXPECT_NEAR(tau[1], 1.0 - relief.share() * 4.0, 1e-12);
  relief.reset();
  EXPECT_EQ(relief.share(), 1.0);
}

TEST(RateRelief, SlowCyclesStayWithinBounds) {
  RateRelief relief;
  for (int k = 0; k < 3; ++k) relief.note(true, 1.0);
  EXPECT_EQ(relief.share(), 0.0);
  for (int k = 0; k < 3; ++k) relief.note(false, 1.0);
  EXPECT_EQ(relief.share(), 1.0);
}

}  // namespace
}  // namespace limber::controller::test_rate_relief
