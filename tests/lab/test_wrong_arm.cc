// Drives that are not where robot.yaml has them: whatever passes the start is stopped before it has
// moved far.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <utility>

#include "lab/lab.h"

namespace limber::test_wrong_arm {
namespace {

// Noticed after 0.03 rad; then the drives hold with hold_kp, against the weight that the wrong
// model feeds forward.
constexpr double kMost_rad = 0.1;

void request(std::int8_t mode, std::int64_t time_ns, Scenario* scenario) {
  mode_request_t message{};
  message.client = kScenarioClient;
  message.request = mode;
  scenario->timeline.push_back({time_ns, message});
}

/// HOLD after 0.3 s.
Scenario held() {
  Scenario scenario;
  scenario.name = "wrong arm";
  request(mode_request_t::REQUEST_HOLD, 300'000'000, &scenario);
  return scenario;
}

/// The greatest motion of a joint until then.
double motion_until(const std::function<bool()>& over, Lab* lab) {
  lab->step();
  const sim_truth_t start = lab->truth();
  double most = 0.0;
  while (!over()) {
    lab->step();
    for (int i = 0; i < start.num_joints; ++i)
      most = std::max(most, std::abs(lab->truth().q[i] - start.q[i]));
  }
  return most;
}

/// Two seconds in HOLD.
double motion(const LoadedRobot& believed, const LoadedRobot& real) {
  const Scenario scenario = held();
  Lab lab(believed, scenario, LabOptions{&real, {}, {}});
  int cycles = 1;
  return motion_until([&cycles] { return cycles++ == 2500; }, &lab);
}

LoadedRobot openarm() { return load_robot("openarm"); }

TEST(WrongArm, AsDescribedItHolds) {
  const LoadedRobot robot = openarm();
  EXPECT_LT(motion(robot, robot), 0.01);
}

TEST(WrongArm, ATurnedSignDoesNotMoveIt) {
  const LoadedRobot robot = openarm();
  for (std::size_t i = 0; i < robot.robot.joints.size(); ++i) {
    LoadedRobot real = openarm();
    real.robot.joints[i].drive.sign *= -1.0;
    EXPECT_LT(motion(robot, real), kMost_rad) << robot.robot.joints[i].name;
  }
}

TEST(WrongArm, AnAngleThatIsOffIsReadSo) {
  const LoadedRobot robot = openarm();
  LoadedRobot real = openarm();
  real.robot.joints[1].drive.offset_rad += 0.3;
  Scenario scenario;
  Lab lab(robot, scenario, LabOptions{&real, {}, {}});
  for (int cycle = 0; cycle < 300; ++cycle) lab.step();
  const double sign = robot.robot.joints[1].drive.sign;
  EXPECT_NEAR(lab.state().q[1] - lab.truth().q[1], 0.3 * sign, 1e-3);
  EXPECT_NEAR(lab.state().q[0], lab.truth().q[0], 1e-3);
}

// A drive that keeps one turn, switched on beyond half a turn from its zero: either way.
TEST(WrongArm, ADriveThatReadsAWholeTurnOffIsHeldWhereItIs) {
  for (const char* name : {"openarm", "edulite_a3", "axol", "desktop2r_ak"}) {
    const LoadedRobot robot = load_robot(name);
    for (std::size_t i = 0; i < robot.robot.joints.size(); ++i) {
      for (const double turn : {2.0 * std::numbers::pi, -2.0 * std::numbers::pi}) {
        LoadedRobot real = load_robot(name);
        real.robot.joints[i].drive.offset_rad += turn;
        EXPECT_LT(motion(robot, real), 0.01) << name << ' ' << robot.robot.joints[i].name;
      }
    }
  }
}

// The same of drives that count turns without power is a wrong zero: they stay off.
TEST(WrongArm, AWholeTurnOfADriveThatKeepsThemIsOutOfRange) {
  const LoadedRobot robot = load_robot("planar2r");
  LoadedRobot real = load_robot("planar2r");
  real.robot.joints[1].drive.offset_rad += 2.0 * std::numbers::pi;
  Lab lab(robot, Scenario{}, LabOptions{&real, {}, {}});
  for (int cycle = 0; cycle < 1000; ++cycle) lab.step();
  EXPECT_TRUE(lab.state().joint_flags[1] & joint_state_t::JOINT_OUT_OF_RANGE);
}

// HOLD carries it with a fraction of the torque, as if a stand did the rest; then a law with the
// whole weight moves it. A range that is too small is found in HOLD.
TEST(WrongArm, AMotorThatMakesAMultipleIsFoundAsTheLawBegins) {
  struct Case {
    const char* robot;
    std::size_t joint;
    double scale;
    int reason;
  };
  using Status = controller_status_t;
  for (const auto& [name, joint, scale, reason] :
       {Case{"desktop2r", 0, 4.0, +Status::REASON_OVERDRIVEN},
        Case{"desktop2r", 0, 2.5, +Status::REASON_OVERDRIVEN},
        Case{"desktop2r", 0, 0.25, +Status::REASON_STRAYED},
        Case{"openarm", 0, 4.0, +Status::REASON_OVERDRIVEN},
        Case{"yam", 2, 2.5, +Status::REASON_STRAYED},
        Case{"yam", 2, 0.25, +Status::REASON_STRAYED}}) {
    const LoadedRobot robot = load_robot(name);
    LoadedRobot real = load_robot(name);
    real.robot.joints[joint].drive.torque_constant_Nm_per_A *= scale;
    Scenario scenario = held();
    request(mode_request_t::REQUEST_ACTIVE, 2'000'000'000, &scenario);
    scenario.plant = std::move(real);
    Lab lab(robot, scenario);
    const auto over = [&lab] {
      return lab.controller_status().mode == Status::MODE_FAULT || lab.time_ns() >= 5'000'000'000;
    };
    const double most = motion_until(over, &lab);
    EXPECT_EQ(lab.controller_status().reason, reason) << name << ' ' << joint << ' ' << scale;
    EXPECT_EQ(lab.controller_status().reason_joint, static_cast<int>(joint)) << name;
    EXPECT_LE(most, 1.1 * kMost_rad) << name << ' ' << joint << ' ' << scale;
  }
}

TEST(WrongArm, SwappedNeighboursDoNotMoveIt) {
  const LoadedRobot robot = openarm();
  for (std::size_t i = 0; i + 1 < robot.robot.joints.size(); ++i) {
    LoadedRobot real = openarm();
    DriveConfig& a = real.robot.joints[i].drive;
    DriveConfig& b = real.robot.joints[i + 1].drive;
    std::swap(a.command_id, b.command_id);
    std::swap(a.reply_id, b.reply_id);
    EXPECT_LT(motion(robot, real), kMost_rad) << robot.robot.joints[i].name << " and the next";
  }
}

}  // namespace
}  // namespace limber::test_wrong_arm
