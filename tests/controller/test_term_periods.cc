// Terms with an evaluation period of their own change when they are due and at no other time.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/controller/rig.h"

namespace limber::test_term_periods {
namespace {

using limber::testing::Rig;
using Status = controller_status_t;
using Gains = compliance_gains_t;

// An arm in motion under a push, with one period longer than the others.
struct Moving {
  Moving(int term, std::int16_t cycles, const std::string& law)
      : rig(limber::testing::seven_joint_arm(), law) {
    rig.to_active();
    Gains gains = rig.gains();
    gains.period_cycles[term] = cycles;
    EXPECT_EQ(rig.controller.on_gains(gains), nullptr);
    rig.plant.F_ext << 8.0, -6.0, 4.0, 0.3, 0.2, -0.2;
    rig.run(0.05);
  }
  Rig rig;
};

// Cycles between changes of one number of the status.
template <typename Number>
std::vector<int> gaps(Rig* rig, Number number) {
  std::vector<int> found;
  double before = number(rig->controller.status());
  int since = 0;
  bool first = true;
  for (int i = 0; i < 100; ++i) {
    rig->step();
    ++since;
    const double now = number(rig->controller.status());
    if (now == before) continue;
    if (!first) found.push_back(since);
    first = false;
    since = 0;
    before = now;
  }
  return found;
}

TEST(TermPeriods, AreReported) {
  Rig rig(limber::testing::seven_joint_arm());
  rig.to_active();
  for (const std::int16_t period : rig.controller.status().term_period_cycles) {
    EXPECT_EQ(period, 1);
  }
  Gains gains = rig.gains();
  for (int i = 0; i < 5; ++i) gains.period_cycles[i] = static_cast<std::int16_t>(2 + i);
  ASSERT_EQ(rig.controller.on_gains(gains), nullptr);
  rig.step();
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(rig.controller.status().term_period_cycles[i], 2 + i);
  }
}

TEST(TermPeriods, CoriolisTorqueChangesWhenItIsDue) {
  const auto coriolis = [](const Status& status) { return double{status.tau_coriolis[1]}; };
  for (const std::int16_t cycles : {1, 4, 25}) {
    Moving moving(Gains::PERIOD_C, cycles, "cartesian_impedance");
    const std::vector<int> found = gaps(&moving.rig, coriolis);
    EXPECT_GE(std::ssize(found), 100 / cycles - 2);
    for (const int gap : found) EXPECT_EQ(gap, cycles);
  }
}

// The tip's twist is J v: with a held J it is not the rate of the pose, which is always of this
// instant.
TEST(TermPeriods, JacobianIsHeldWhileThePoseIsNot) {
  for (const std::int16_t cycles : {1, 50}) {
    Moving moving(Gains::PERIOD_J, cycles, "cartesian_impedance");
    Rig& rig = moving.rig;
    controller::ArmModel model(rig.robot);
    double worst = 0.0;
    for (int i = 0; i < 100; ++i) {
      rig.step();
      const Status& status = rig.controller.status();
      const VectorJ q = Eigen::Map<const Eigen::VectorXd>(rig.state.q, 7);
      const VectorJ v = Eigen::Map<const Eigen::VectorXd>(rig.state.v, 7);
      const Vector6 V = model.jacobian(q) * v;
      EXPECT_LT((model.tip_pose(q).p - Eigen::Vector3d::Map(status.p_BT)).norm(), 1e-12);
      worst = std::max(worst, (Vector6::Map(status.V_BT) - V).norm() / V.norm());
    }
    if (cycles == 1) {
      EXPECT_LT(worst, 1e-9);
    } else {
      EXPECT_GT(worst, 1e-4);
    }
  }
}

// A law that starts between two evaluations does not wait for the next with nothing to hold by.
TEST(TermPeriods, ALawStartsWithTermsOfNow) {
  Rig rig(limber::testing::seven_joint_arm());
  rig.to_active();
  rig.plant.F_ext << 4.0, -3.0, 2.0, 0.0, 0.0, 0.0;
  rig.run(1.0);
  const double before = Vector6::Map(rig.controller.status().e).head<3>().norm();
  Gains gains = rig.gains();
  gains.law = "mapped_joint_impedance";
  gains.period_cycles[Gains::PERIOD_K] = gains.period_cycles[Gains::PERIOD_D] = 1000;
  ASSERT_EQ(rig.controller.on_gains(gains), nullptr);
  rig.run(0.6);
  EXPECT_LT(Vector6::Map(rig.controller.status().e).head<3>().norm(), 1.5 * before);
}

TEST(TermPeriods, RefusesPeriodsOutOfRange) {
  Rig rig(limber::testing::seven_joint_arm());
  rig.to_active();
  for (const std::int16_t period : {-1, 0, 1001}) {
    Gains gains = rig.gains();
    gains.period_cycles[Gains::PERIOD_K] = period;
    EXPECT_STREQ(rig.controller.on_gains(gains), "period_cycles must be within 1..1000 cycles");
  }
}

}  // namespace
}  // namespace limber::test_term_periods
