// Two motors a joint whose springs are not those of robot.yaml: the controller takes the arm over
// with the preload torque that the drives apply.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "controller/laws/registry.h"
#include "lab/lab.h"
#include "tests/support/mutation.h"

namespace limber::test_two_motors {
namespace {

const char* const kScenario = R"(format: limber-scenario/1
name: softer_springs
description: springs that pull a quarter less than robot.yaml believes
robot: antagonist2r
duration_s: 5
plant_overrides:
  joints:
    shoulder: {transmission: {spring: {k2_Nm_per_rad2: 300}}}
    elbow: {transmission: {spring: {k2_Nm_per_rad2: 300}}}
timeline:
  - {at_s: 0.3, mode: hold}
  - {at_s: 2.0, fault: {joint: elbow, kind: silent, for_s: 0.1}}
  - {at_s: 3.0, mode: acknowledge}
  - {at_s: 3.2, mode: hold}
)";

LoadedRobot weightless(LoadedRobot robot) {
  std::ranges::fill(robot.robot.gravity, 0.0);
  return robot;
}

struct TwoMotorLab {
  explicit TwoMotorLab(const std::string& text, const LoadedRobot& arm = load_robot("antagonist2r"))
      : robot(arm),
        scenario(
            load_scenario(folder.write("scenario.yaml", text), robot, &controller::law_catalog())),
        lab(robot, scenario) {}
  testing::TemporaryFolder folder;
  LoadedRobot robot;
  Scenario scenario;
  Lab lab;
};

TEST(TwoMotors, AreTakenOverWithoutAStep) {
  TwoMotorLab run(kScenario);
  Lab& lab = run.lab;
  const auto run_to = [&lab](double time_s) {
    while (lab.time_ns() < std::llround(time_s * 1e9)) lab.step();
  };
  run_to(2.5);
  ASSERT_EQ(lab.state().drive_state, +joint_state_t::DRIVE_HOLD);
  // What robot.yaml's springs would pull with is far from what holds these.
  for (int i = 0; i < 2; ++i) {
    // Quadratic springs: k2 ((c + x)^2 + (c - x)^2) / 2.
    const double c = lab.state().preload[i];
    const double x = lab.state().theta[i] - lab.state().q[i];
    const double square = c * c + x * x;
    const double applied = lab.state().tau_preload_applied[i];
    EXPECT_GT(std::abs(400.0 * square - applied), 2.0) << i;
    EXPECT_NEAR(300.0 * square, applied, 0.3) << i << ": the springs there are";
  }
  int takeovers = 0;
  double slowest = 0.0;
  while (lab.time_ns() < 4'500'000'000) {
    const auto before = lab.state();
    lab.step();
    const bool on = lab.state().drive_state == joint_state_t::DRIVE_ON;
    if (before.drive_state != joint_state_t::DRIVE_ON && on) {
      ++takeovers;
      for (int i = 0; i < 2; ++i) {
        const double applied = lab.state().tau_preload_applied[i];
        EXPECT_NEAR(lab.torque().tau_preload[i], applied, 1e-3) << i;
        EXPECT_NEAR(before.tau_preload_applied[i], applied, 0.3) << i;
      }
    }
    if (on) slowest = std::max(slowest, std::abs<double>(lab.state().preload_dot[0]));
  }
  EXPECT_EQ(takeovers, 1);
  EXPECT_LT(slowest, 0.5) << "the preload is not let go";
}

// The drives are off for 45 ms: the springs unwind. ACTIVE, asked for as soon as the arm is held
// again, comes when they are wound up.
const char* const kSlack = R"(format: limber-scenario/1
name: slack_springs
description: the springs unwind while the drives are off
robot: antagonist2r
duration_s: 5
timeline:
  - {at_s: 0.3, mode: hold}
  - {at_s: 2.0, mode: idle}
  - {at_s: 2.045, mode: hold}
  - {at_s: 2.045, mode: active}
)";

TEST(TwoMotors, AreWoundUpBeforeALawMovesThem) {
  TwoMotorLab run(kSlack);
  Lab& lab = run.lab;
  double least = 1.0;
  bool active = false;
  while (!active && lab.time_ns() < 5'000'000'000) {
    lab.step();
    if (lab.time_ns() < 2'010'000'000) continue;
    for (int i = 0; i < 2; ++i) least = std::min<double>(least, lab.state().preload[i]);
    active = lab.controller_status().mode == controller_status_t::MODE_ACTIVE;
    if (!active) continue;
    for (int i = 0; i < 2; ++i) EXPECT_GE(lab.state().preload[i], 0.175) << i;
  }
  EXPECT_LT(least, -0.2) << "the springs were slack";
  EXPECT_TRUE(active) << "mode " << int{lab.controller_status().mode} << ", fault "
                      << int{lab.state().fault};
}

/// The drives are off from 2 s on, and hold again from `hold_s` on.
std::string off_until(double hold_s) {
  return "format: limber-scenario/1\n"
         "name: off\n"
         "description: the springs unwind while the drives are off\n"
         "robot: antagonist2r\n"
         "duration_s: 10\n"
         "timeline:\n"
         "  - {at_s: 0.3, mode: hold}\n"
         "  - {at_s: 2.0, mode: idle}\n"
         "  - {at_s: " +
         std::to_string(hold_s) + ", mode: hold}\n";
}

// An arm that somebody supports meanwhile.
TEST(TwoMotors, AreWoundUpHoweverLongTheyWereOff) {
  const LoadedRobot robot = weightless(load_robot("antagonist2r"));
  for (const double hold_s : {2.06, 2.1, 2.3, 4.0}) {
    TwoMotorLab run(off_until(hold_s), robot);
    Lab& lab = run.lab;
    while (lab.time_ns() < std::llround((hold_s + 3.0) * 1e9)) lab.step();
    EXPECT_EQ(lab.controller_status().mode, +controller_status_t::MODE_HOLD) << hold_s;
    for (int i = 0; i < 2; ++i) EXPECT_NEAR(lab.state().preload[i], 0.25, 0.01) << hold_s;
  }
}

// HOLD cannot catch an arm that falls between slack springs. What it does there is explained all
// the same: links and motors are half a radian apart, and each has its own energy.
TEST(TwoMotors, AFallBetweenSlackSpringsHasNoEnergyOfUnknownOrigin) {
  TwoMotorLab run(off_until(2.06));
  Lab& lab = run.lab;
  double most_apart_rad = 0.0;
  double most_kinetic_J = 0.0;
  while (lab.time_ns() < 2'450'000'000) {
    lab.step();
    const controller_status_t& status = lab.controller_status();
    ASSERT_NE(status.reason, +controller_status_t::REASON_ENERGY) << 1e-9 * lab.time_ns();
    EXPECT_LT(status.unexplained_energy_J, 0.3);
    most_kinetic_J = std::max(most_kinetic_J, status.kinetic_energy_J);
    for (int i = 0; i < 2; ++i)
      most_apart_rad = std::max(most_apart_rad, std::abs(lab.state().theta[i] - lab.state().q[i]));
  }
  EXPECT_GT(most_apart_rad, 0.4);
  EXPECT_GT(most_kinetic_J, 4.0);
}

// Where springs are nearly slack, a static equilibrium is there in one cycle and gone in the next.
TEST(TwoMotors, TheLawsPositionDoesNotChangeBackAndForth) {
  TwoMotorLab run(off_until(2.06));
  Lab& lab = run.lab;
  int changes = 0;
  int since = 1000;
  bool last = true;
  while (lab.time_ns() < 2'450'000'000) {
    lab.step();
    if (lab.time_ns() < 2'080'000'000) continue;
    const bool solved =
        (lab.controller_status().limits & controller_status_t::LIMIT_STATIC_UNSOLVED) == 0;
    ++since;
    if (solved == last) continue;
    if (solved) {
      EXPECT_GE(since, 50) << 1e-9 * lab.time_ns();
    }
    since = 0;
    last = solved;
    ++changes;
  }
  EXPECT_GE(changes, 1);
}

}  // namespace
}  // namespace limber::test_two_motors
