// Whatever happens to law, gains and goals, the torque goes on where it was, within its limits.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "controller/laws/registry.h"
#include "tests/controller/rig.h"
#include "tools/allocations/allocations.h"

namespace limber::test_continuity {
namespace {

using limber::testing::Rig;
using Status = controller_status_t;

// +Status::X below: message constants have no address to bind a reference to.
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
// with_drives(): what the gate lets pass in a cycle.
constexpr double kGateStep = 1.0;
// Limits that would hide a jump of the law.
constexpr int kClamped = int{Status::LIMIT_RATE} | int{Status::LIMIT_TORQUE};

LoadedRobot arm() { return limber::testing::seven_joint_arm(); }

std::vector<std::string> laws_of_rigid_arms() {
  const unsigned sensors = controller::sensors_of(arm().robot);
  std::vector<std::string> names;
  for (const controller::LawEntry& law : controller::laws()) {
    if (controller::check_law(law, sensors) == nullptr) names.emplace_back(law.name);
  }
  return names;
}

// Gains that every law can work with: a contact source, no more rows than joints.
void select(Rig* rig, const std::string& law) {
  compliance_gains_t gains = rig->gains();
  gains.law = law;
  gains.contact = compliance_gains_t::CONTACT_JOINT_TORQUE;
  for (int i = rig->state.num_joints; i < 6; ++i) gains.K_x[i][i] = 0.0;
  const char* refused = rig->controller.on_gains(gains);
  ASSERT_EQ(refused, nullptr) << law << ": " << refused;
}

TEST(Continuity, GainsAndGoalsNeverJump) {
  Rig rig(arm());
  rig.to_active();
  rig.plant.F_ext << 10.0, 5.0, -5.0, 0.3, 0.2, 0.1;
  rig.run(0.5);
  rig.clear_jumps();
  const auto changed = [&](const char* what) {
    const VectorJ before = rig.tau();
    rig.step();
    EXPECT_LT((rig.tau() - before).cwiseAbs().maxCoeff(), 0.05 * kGateStep) << what;
    rig.run(0.4);
  };
  compliance_gains_t gains = rig.gains();
  gains.ramp_s = 0.3;
  for (int i = 0; i < 3; ++i) gains.K_x[i][i] = 3000.0;
  ASSERT_EQ(rig.controller.on_gains(gains), nullptr);
  changed("stiffer");
  for (int i = 3; i < 6; ++i) gains.K_x[i][i] = 0.0;
  ASSERT_EQ(rig.controller.on_gains(gains), nullptr);
  changed("rotation free");
  rig.run(0.2);
  gains.orientation = compliance_gains_t::ORIENTATION_QUAT;
  for (int i = 3; i < 6; ++i) gains.K_x[i][i] = 20.0;
  ASSERT_EQ(rig.controller.on_gains(gains), nullptr);
  changed("other orientation error");
  compliance_goal_t goal = rig.goal();
  goal.offset[2] = -0.05;
  goal.F_ff[0] = 20.0;
  ASSERT_EQ(rig.controller.on_goal(goal), nullptr);
  changed("goal");
  goal.offset[4] = 0.3;
  ASSERT_EQ(rig.controller.on_goal(goal), nullptr);
  changed("goal while moving");
  goal.kind = compliance_goal_t::GOAL_WRENCH;
  goal.F_ff[0] = 0.0;
  ASSERT_EQ(rig.controller.on_goal(goal), nullptr);
  changed("wrench");
  rig.run(3.0);
  EXPECT_EQ(rig.limits() & kClamped, 0);
  EXPECT_EQ(rig.mode(), +Status::MODE_ACTIVE);
}

// Whatever comes in, what goes out is finite, within the limits and no step larger than the gate
// allows.
TEST(Continuity, TorqueIsBoundedUnderRandomInput) {
  const auto names = laws_of_rigid_arms();
  for (unsigned seed = 0; seed < 2 * names.size(); ++seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> chance(0.0, 1.0);
    const std::string& law = names[seed % names.size()];
    const int joints = 1 + static_cast<int>(seed) % 7;
    SCOPED_TRACE(law + ", joints: " + std::to_string(joints));
    Rig rig(limber::testing::random_arm(joints, seed, true));
    select(&rig, law);
    rig.to_active();
    const int n = rig.state.num_joints;
    VectorJ before = rig.tau();
    for (int i = 0; i < 400; ++i) {
      ++rig.state.seq;
      rig.state.time_ns += 1'000'000;
      const double size = std::pow(10.0, 8.0 * chance(generator) - 6.0);
      for (int k = 0; k < n; ++k) {
        rig.state.q[k] += size * (chance(generator) - 0.5);
        rig.state.v[k] = size * (chance(generator) - 0.5);
        rig.state.tau_applied[k] = before[k];
        if (chance(generator) < 1e-3) rig.state.v[k] = kNaN;
      }
      if (chance(generator) < 0.05) {
        compliance_goal_t goal = rig.goal();
        for (double& x : goal.offset) x = chance(generator) - 0.5;
        rig.controller.on_goal(goal);
      }
      if (chance(generator) < 0.05) {
        compliance_gains_t gains = rig.gains();
        for (int k = 0; k < 6; ++k) gains.K_x[k][k] = 1e4 * chance(generator);
        rig.controller.on_gains(gains);
      }
      const joint_command_t& answer = rig.controller.step(rig.state);
      for (int k = 0; k < n; ++k) {
        ASSERT_LE(std::abs(answer.tau[k]), 60.0);
        ASSERT_LE(std::abs(answer.tau_gravity[k]), 60.0);
        ASSERT_LE(std::abs(answer.tau[k] - before[k]), 0.8 * kGateStep + 1e-12);
        before[k] = answer.tau[k];
      }
    }
  }
}

TEST(Continuity, NothingInTheCycleAllocates) {
  for (const std::string& law : laws_of_rigid_arms()) {
    for (const int n : {1, 2, 7, 16}) {
      SCOPED_TRACE(law + ", joints: " + std::to_string(n));
      Rig rig(limber::testing::random_arm(n, 5, true));
      select(&rig, law);
      const std::vector<TimedMessage> timeline{{1'400'000'000, push_t{}}};
      rig.controller.set_timeline(&timeline);
      compliance_gains_t gains = rig.gains();
      compliance_goal_t goal = rig.goal();
      goal.offset[0] = 0.01;
      const auto before = limber::allocations();
      rig.run(0.12);
      rig.request(mode_request_t::REQUEST_HOLD);
      rig.run(0.6);
      rig.request(mode_request_t::REQUEST_ACTIVE);
      rig.run(0.6);
      gains.orientation = compliance_gains_t::ORIENTATION_QUAT;
      rig.controller.on_gains(gains);
      rig.controller.on_goal(goal);
      rig.run(0.2);
      rig.request(mode_request_t::REQUEST_STOP);
      rig.run(0.4);
      rig.controller.on_silence();
      rig.run(0.1);
      EXPECT_EQ(limber::allocations(), before);
    }
  }
}

}  // namespace
}  // namespace limber::test_continuity
