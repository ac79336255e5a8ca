// A stand, or a motor that makes more than it reports: one joint, to the last bit.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "controller/watches/scale_watch.h"

namespace limber::controller::test_scale_watch {
namespace {

using Seen = ScaleWatch::Seen;
constexpr double kStep_s = 1.0 / 64.0;  // two of them are kLasting_s
constexpr double kFriction_Nm = 0.5;

/// 8 N m of weight, of which 6 seem to come from outside: a motor that makes four times as much.
constexpr Seen kHeld{6.0, 2.0, 1.0};

ScaleWatch held(const Seen& seen = kHeld, double weight = 8.0) {
  ScaleWatch watch;
  watch.hold(seen, weight, kFriction_Nm);
  return watch;
}
constexpr double above(double x) { return std::nextafter(x, HUGE_VAL); }
constexpr double below(double x) { return std::nextafter(x, -HUGE_VAL); }

TEST(ScaleWatch, SuspectsTwoFifthsOfTheWeight) {
  for (const double sign : {1.0, -1.0}) {
    const auto suspected = [sign](double r) {
      return held({sign * r, sign * 2.0, 0.0}, sign * 8.0).suspected();
    };
    EXPECT_TRUE(suspected(0.4 * 8.0));
    EXPECT_FALSE(suspected(below(0.4 * 8.0)));
  }
}

TEST(ScaleWatch, AndAsMuchAsFrictionMayHold) {
  EXPECT_TRUE(held({kFriction_Nm, 0.2, 0.0}, 0.7).suspected());
  EXPECT_FALSE(held({below(kFriction_Nm), 0.2, 0.0}, 0.7).suspected());
}

TEST(ScaleWatch, OnlyWhatHelpsAMotorThatPulls) {
  EXPECT_FALSE(held({-6.0, 2.0, 0.0}).suspected()) << "a payload";
  EXPECT_FALSE(held({6.0, -2.0, 0.0}).suspected()) << "more than a stand";
  EXPECT_FALSE(held({6.0, 0.0, 0.0}).suspected());
  EXPECT_FALSE(held({6.0, 2.0, 0.0}, 0.0).suspected()) << "nothing to carry";
  EXPECT_FALSE(held({std::nan(""), 2.0, 0.0}).suspected());
}

TEST(ScaleWatch, TheLastCycleOfHoldCounts) {
  ScaleWatch watch = held();
  watch.hold({1.0, 2.0, 0.0}, 8.0, kFriction_Nm);
  EXPECT_FALSE(watch.suspected());
  watch = held();
  watch.forget();
  EXPECT_FALSE(watch.suspected());
  EXPECT_FALSE(watch.overdriven({12.0, 4.0, 2.0}, kStep_s));
}

TEST(ScaleWatch, IsFoundOnceTheJointHasMoved) {
  for (const double sign : {1.0, -1.0}) {
    const double edge = 1.0 + sign * ScaleWatch::kMovedBy;
    const double within = sign > 0.0 ? 1.0 + 0.0299 : 1.0 - 0.0299;
    ScaleWatch watch = held();
    EXPECT_FALSE(watch.overdriven({6.0, 2.0, within}, kStep_s));
    EXPECT_TRUE(watch.overdriven({6.0, 2.0, edge + sign * 1e-9}, kStep_s));
  }
  ScaleWatch exact;
  exact.hold({6.0, 2.0, 0.0}, 8.0, kFriction_Nm);
  EXPECT_FALSE(exact.overdriven({6.0, 2.0, below(ScaleWatch::kMovedBy)}, kStep_s));
  EXPECT_TRUE(exact.overdriven({6.0, 2.0, ScaleWatch::kMovedBy}, kStep_s));
}

TEST(ScaleWatch, OrOnceItsTorqueHasGrown) {
  ScaleWatch watch = held({3.0, 1.0, 0.0}, 4.0);
  EXPECT_FALSE(watch.overdriven({3.0 * 1.4, below(1.4), 0.0}, kStep_s));
  EXPECT_TRUE(watch.overdriven({3.0 * 1.4, 1.4, 0.0}, kStep_s));
}

// r is 4 where (tau / tau in HOLD) r is 3 or 5: a quarter of it either way.
TEST(ScaleWatch, InProportionWithinAQuarter) {
  const auto like = [](double r_held) {
    return held({r_held, 1.0, 0.0}, 4.0).overdriven({4.0, 1.0, 0.1}, kStep_s);
  };
  EXPECT_TRUE(like(3.0));
  EXPECT_TRUE(like(5.0));
  EXPECT_FALSE(like(below(3.0)));
  EXPECT_FALSE(like(above(5.0)));
}

TEST(ScaleWatch, OutOfProportionForThirtyMillisecondsItIsAStand) {
  const Seen lifted{2.0, 6.0, 1.0};  // off its stand by a law that carries the weight
  ScaleWatch watch = held();
  EXPECT_FALSE(watch.overdriven(lifted, kStep_s));
  EXPECT_TRUE(watch.suspected());
  EXPECT_FALSE(watch.overdriven(kHeld, kStep_s)) << "it begins anew";
  EXPECT_FALSE(watch.overdriven(lifted, kStep_s));
  EXPECT_TRUE(watch.suspected());
  EXPECT_FALSE(watch.overdriven(lifted, kStep_s));
  EXPECT_FALSE(watch.suspected());
  EXPECT_FALSE(watch.overdriven({12.0, 4.0, 2.0}, kStep_s)) << "and stays one";
}

TEST(ScaleWatch, ExactlyThatLongIsLongEnough) {
  ScaleWatch watch = held();
  EXPECT_FALSE(watch.overdriven({0.0, 8.0, 1.0}, ScaleWatch::kLasting_s));
  EXPECT_FALSE(watch.suspected());
  watch = held();
  EXPECT_FALSE(watch.overdriven({0.0, 8.0, 1.0}, below(ScaleWatch::kLasting_s)));
  EXPECT_TRUE(watch.suspected());
}

TEST(ScaleWatch, HoldBeginsTheTimeAnew) {
  ScaleWatch watch = held();
  EXPECT_FALSE(watch.overdriven({0.0, 8.0, 1.0}, kStep_s));
  watch.hold(kHeld, 8.0, kFriction_Nm);
  EXPECT_FALSE(watch.overdriven({0.0, 8.0, 1.0}, kStep_s));
  EXPECT_TRUE(watch.suspected());
}

TEST(ScaleWatch, NaNIsOutOfProportion) {
  ScaleWatch watch = held();
  for (int k = 0; k < 2; ++k)
    EXPECT_FALSE(watch.overdriven({std::numeric_limits<double>::quiet_NaN(), 2.0, 2.0}, kStep_s));
  EXPECT_FALSE(watch.suspected());
}

}  // namespace
}  // namespace limber::controller::test_scale_watch
