// Heat, velocity and torque of one drive against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "drivers/drive/drive_warning.h"
#include "drivers/drive/torque_watch.h"
#include "drivers/drive/velocity_watch.h"

namespace limber::test_drive_watches {
namespace {

constexpr double kPeriod_s = 1e-3;
constexpr double kTau_s = 0.5;

TEST(HeatWatch, IsToldOnceAboutALimitThatIsSwayedAbout) {
  HeatWatch heat(80.0);
  heat.add(80.0);
  EXPECT_FALSE(heat.hot());
  for (double temperature : {81.0, 79.0, 81.0, 75.5}) {
    heat.add(temperature);
    EXPECT_TRUE(heat.hot()) << temperature;
  }
  for (double temperature : {75.0, 79.0, 80.0}) {
    heat.add(temperature);
    EXPECT_FALSE(heat.hot()) << temperature;
  }
  heat.add(80.5);
  EXPECT_TRUE(heat.hot());
}

TEST(HeatWatch, OfSeveralReadingsAsManyInARowTellEitherWay) {
  HeatWatch heat(90.0, 3);
  const auto hot_after = [&heat](std::initializer_list<double> temperatures) {
    for (double temperature : temperatures) heat.add(temperature);
    return heat.hot();
  };
  EXPECT_FALSE(hot_after({90.0, 90.0, 90.0, 90.0})) << "the limit itself";
  EXPECT_FALSE(hot_after({91.0, 255.0, 30.0})) << "two odd ones";
  EXPECT_FALSE(hot_after({91.0, 91.0, 90.0, 91.0, 91.0}));
  EXPECT_TRUE(hot_after({91.0}));
  EXPECT_TRUE(hot_after({85.5, 85.5, 85.5, 85.5}));
  EXPECT_TRUE(hot_after({85.0, 20.0, 86.0, 85.0, 85.0}));
  EXPECT_FALSE(hot_after({85.0}));
  EXPECT_FALSE(hot_after({91.0, 91.0})) << "counted afresh";
}

TEST(HeatWatch, AReadingThatIsNoneTellsNothing) {
  HeatWatch heat(90.0, 2);
  heat.add(std::nan(""));
  heat.add(91.0);
  EXPECT_FALSE(heat.hot());
  heat.add(HUGE_VAL);
  heat.add(91.0);
  EXPECT_TRUE(heat.hot());
  for (int i = 0; i < 3; ++i) heat.add(std::nan(""));
  EXPECT_TRUE(heat.hot());
}

/// Cycles until a velocity field of `velocity` at a standing joint contradicts, or -1 in 10 s.
int cycles_standing(double velocity, double limit, double position = 0.0) {
  VelocityWatch watch(limit, 1e-6);
  for (int i = 0; i < 10'000; ++i) {
    watch.add(position, velocity, i * kPeriod_s);
    if (watch.contradicts()) return i;
  }
  return -1;
}

// e = dv tau (1 - exp(-t / tau)) reaches most at t = -tau ln(1 - most / (dv tau)).
double found_at_s(double most, double dv) { return -kTau_s * std::log(1.0 - most / (dv * kTau_s)); }

TEST(VelocityWatch, AStandingJointWithAVelocityIsFoundWhenTheFormulaHasIt) {
  for (double dv : {4.0, 2.0, 1.0, 0.5}) {
    const double t_s = found_at_s(0.08 + 0.07 * dv, dv);
    EXPECT_NEAR(cycles_standing(dv, 30.0) * kPeriod_s, t_s, 2.0 * kPeriod_s) << dv;
    EXPECT_NEAR(cycles_standing(-dv, 30.0) * kPeriod_s, t_s, 2.0 * kPeriod_s);
  }
  EXPECT_EQ(cycles_standing(0.18, 30.0), -1);
  EXPECT_EQ(cycles_standing(0.0, 30.0, 2.5), -1);
}

// A slow joint: a quarter of its greatest velocity for half a second.
TEST(VelocityWatch, NoLaterThanByAQuarterOfTheGreatestVelocity) {
  for (double share : {2.0, 1.0, 0.5}) {
    const double t_s = found_at_s(0.25 * kTau_s * 0.5, share * 0.5);
    EXPECT_NEAR(cycles_standing(share * 0.5, 0.5) * kPeriod_s, t_s, 2.0 * kPeriod_s) << share;
  }
}

// The angle runs away by 2 rad/s; the joint stands, and its velocity says so.
TEST(VelocityWatch, AnAngleThatDriftsIsFound) {
  VelocityWatch watch(30.0, 1e-6);
  int i = 0;
  for (; i < 1000 && !watch.contradicts(); ++i) watch.add(i * kPeriod_s * 2.0, 0.0, i * kPeriod_s);
  EXPECT_NEAR(i * kPeriod_s, found_at_s(0.08, 2.0), 0.002);
}

// What has been fast may be late: 70 ms of the greatest speed, of which after half a second a third
// is left.
TEST(VelocityWatch, TheGreatestSpeedFades) {
  VelocityWatch watch(100.0, 1e-6);
  double q = 0.0;
  int i = 0;
  for (; i < 1000; ++i, q += 10.0 * kPeriod_s) watch.add(q, 10.0, i * kPeriod_s);
  watch.add(q - 0.7, 0.0, i * kPeriod_s);  // 0.08 + 0.7 rad are allowed
  EXPECT_FALSE(watch.contradicts());
  for (int k = 1; k <= 500; ++k) watch.add(q - 0.7, 0.0, (i + k) * kPeriod_s);
  EXPECT_FALSE(watch.contradicts()) << "what is wrong fades alike";
  const double most = 0.08 + 0.7 * std::exp(-1.0);
  watch.add(q - 0.7 - (most - 0.7 * std::exp(-1.0)) - 0.02, 0.0, (i + 501) * kPeriod_s);
  EXPECT_TRUE(watch.contradicts());
}

// q = A sin(w t) at the greatest allowed speed, reported by counts and with a filter of 20 ms.
TEST(VelocityWatch, AFilteredVelocityOfAFastSwingIsNone) {
  constexpr double kLimit = 5.0, kCount = 25.0 / 65535.0, kLag_s = 0.02;
  for (double omega : {1.0, 5.0, 20.0, 60.0}) {
    VelocityWatch watch(kLimit, kCount);
    double filtered = 0.0;
    for (int i = 0; i < 5000; ++i) {
      const double t = i * kPeriod_s;
      const double q = kLimit / omega * std::sin(omega * t);
      filtered += kPeriod_s / kLag_s * (kLimit * std::cos(omega * t) - filtered);
      watch.add(std::floor(q / kCount) * kCount, filtered, t);
      ASSERT_FALSE(watch.contradicts()) << omega << " at " << t;
    }
  }
}

// At full speed one side sleeps for 50 ms: the position goes on, or the time does.
TEST(VelocityWatch, APauseIsNone) {
  for (int sign : {-1, 1}) {
    VelocityWatch watch(5.0, 1e-4);
    double q = 0.0;
    double t = 0.0;
    for (int i = 0; i < 1000; ++i) {
      t += kPeriod_s + (i == 500 && sign > 0 ? 0.05 : 0.0);
      q += 5.0 * (kPeriod_s + (i == 500 && sign < 0 ? 0.05 : 0.0));
      watch.add(q, 5.0, t);
      ASSERT_FALSE(watch.contradicts());
    }
  }
}

TEST(VelocityWatch, TheWrongSignIsFoundInAMotion) {
  VelocityWatch watch(5.0, 1e-4);
  int i = 0;
  for (; i < 1000 && !watch.contradicts(); ++i) watch.add(-i * 1e-3 * 2.0, 2.0, i * kPeriod_s);
  // Wrong by 4 rad/s, at 2 rad/s.
  EXPECT_NEAR(i * kPeriod_s, found_at_s(0.08 + 0.14, 4.0), 0.003);
}

TEST(VelocityWatch, ANumberThatIsNoneIsFound) {
  VelocityWatch watch(5.0, 1e-4);
  watch.add(0.0, 0.0, 0.0);
  watch.add(0.0, std::nan(""), kPeriod_s);
  EXPECT_TRUE(watch.contradicts());
  watch.reset();
  EXPECT_FALSE(watch.contradicts());
}

int cycles_torque(double reported, double commanded) {
  TorqueWatch watch(8.0);
  for (int i = 1; i < 1000; ++i) {
    watch.add(reported, commanded, kPeriod_s);
    if (watch.contradicts()) return i;
  }
  return -1;
}

TEST(TorqueWatch, FarBeyondForATenthOfASecond) {
  EXPECT_NEAR(cycles_torque(-4.1, 0.0), 101, 1);
  EXPECT_NEAR(cycles_torque(7.0, 2.9), 101, 1);
  EXPECT_NEAR(cycles_torque(std::nan(""), 0.0), 11, 1);
}

TEST(TorqueWatch, OppositeForAHundredthOfASecond) {
  for (const double sign : {1.0, -1.0}) {
    EXPECT_NEAR(cycles_torque(-0.9 * sign, 0.1 * sign), 11, 1);
    EXPECT_NEAR(cycles_torque(-8.0 * sign, 8.0 * sign), 11, 1);
    EXPECT_EQ(cycles_torque(-0.7 * sign, 8.0 * sign), -1) << "less than a tenth of the limit";
  }
}

TEST(TorqueWatch, LessThanCommandedIsNone) {
  for (double reported : {8.0, 4.0, 0.0, -0.7}) EXPECT_EQ(cycles_torque(reported, 8.0), -1);
  for (double reported : {3.9, -3.9}) EXPECT_EQ(cycles_torque(reported, 0.0), -1);
}

// A drive whose torque follows with a lag of 20 ms, told to turn around again and again.
TEST(TorqueWatch, ALagIsNoOppositeTorque) {
  for (const int half_period : {1, 5, 20, 50, 200}) {
    TorqueWatch watch(8.0);
    double torque = 0.0;
    for (int i = 0; i < 2000; ++i) {
      const double commanded = i / half_period % 2 == 0 ? 8.0 : -8.0;
      watch.add(torque, commanded, kPeriod_s);
      ASSERT_FALSE(watch.contradicts()) << half_period << " at " << i;
      torque += kPeriod_s / 0.02 * (commanded - torque);
    }
  }
}

TEST(TorqueWatch, AnotherBeginningAfterEachFit) {
  TorqueWatch watch(8.0);
  for (int i = 0; i < 1000; ++i) {
    watch.add(i % 50 == 0 ? 0.0 : 8.0, 0.0, kPeriod_s);
    ASSERT_FALSE(watch.contradicts());
  }
}

}  // namespace
}  // namespace limber::test_drive_watches
