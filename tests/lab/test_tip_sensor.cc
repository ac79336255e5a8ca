// From a push on the simulated hand over the sensor, its bus and the driver to the contact wrench:
// it is the wrench that the scenario asked for.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>

#include "controller/laws/registry.h"
#include "controller/model/arm_terms.h"
#include "controller/observers/tip_force.h"
#include "lab/lab.h"
#include "tests/support/mutation.h"
#include "tests/support/source_path.h"
#include "tools/allocations/allocations.h"

namespace limber::test_tip_sensor {
namespace {

using testing::Mutation;

const std::string kOpenArm = source_path("robots/openarm/");

/// Half the hand's 0.386 kg is tool. The seven motors leave no room for a sensor on their bus: it
/// has one of its own.
const char* const kIdeal = R"(
tip_sensor:
  model: ideal
  protocol: limber_ft
  bus: wrist
  id: 80
  reply_id: 81
  pose: {position_m: [0, 0.01, -0.04], rpy_rad: [0.3, -0.2, 0.5]}
  range: {force_N: 1000, torque_Nm: 100}
  bias: {force_N: [1, -2, 3], torque_Nm: [0.1, 0.2, -0.3]}
  tool: {mass_kg: 0.19, centre_of_mass_m: [0.01, 0, 0.05]}
)";

/// What one may expect of a small sensor: 0.2 N and 8 mN m steps, noise of half of that, a filter
/// of 1.6 ms (100 Hz).
const char* const kReal = R"(
tip_sensor:
  model: small
  protocol: robotous_rft
  bus: wrist
  id: 100
  reply_ids: [1, 2]
  pose: {position_m: [0, 0.01, -0.04], rpy_rad: [0.3, -0.2, 0.5]}
  range: {force_N: 150, torque_Nm: 4}
  resolution: {force_N: 0.2, torque_Nm: 0.008}
  noise: {force_N: 0.1, torque_Nm: 0.004, seed: 3}
  filter_time_constant_s: 0.0016
  tool: {mass_kg: 0.19, centre_of_mass_m: [0.01, 0, 0.05]}
)";

/// robot.yaml of openarm with a bus for the sensor after the motors' one.
std::string with_sensor(const std::string& sensor) {
  const std::string speed = sensor == kIdeal ? "fd: true, data_bitrate_bps: 5000000, " : "";
  const std::string bus =
      "  - {name: wrist, can: \"virtual:wrist\", " + speed + "bitrate_bps: 1000000}\n";
  const Mutation change = {"", "\n# A drive that hears", bus + "\n# A drive that hears", ""};
  return testing::apply(testing::read_text(kOpenArm + "robot.yaml") + sensor, change).text;
}

const char* const kScenario = R"(format: limber-scenario/1
robot: {}/
duration_s: 6
friction: false
timeline:
  - {at_s: 0.3, mode: hold}
  - {at_s: 0.8, mode: active}
  - {at_s: 0.9, gains: {law: cartesian_impedance}}
)";

struct Stage {
  Stage(const std::string& sensor, const std::string& entries)
      : robot(load(sensor)),
        scenario(load_scenario(write_scenario(entries), robot, &controller::law_catalog())),
        lab(robot, scenario),
        model(robot),
        terms(robot.robot.size()),
        force(robot.robot) {}

  LoadedRobot load(const std::string& sensor) {
    folder.write("robot.urdf", testing::read_text(kOpenArm + "robot.urdf"));
    folder.write("robot.yaml", with_sensor(sensor));
    return load_robot(folder.path());
  }
  std::string write_scenario(const std::string& entries) {
    std::string text = kScenario;
    text.replace(text.find("{}"), 2, folder.path());
    return folder.write("scenario.yaml", text + entries);
  }

  void run_to(double time_s) {
    while (lab.time_ns() < std::llround(time_s * 1e9)) lab.step();
  }
  /// Of the state published last.
  const Vector6& F_ext(const Vector6& A_BT = Vector6::Zero()) {
    const joint_state_t& state = lab.state();
    const VectorJ q = Eigen::Map<const Eigen::VectorXd>(state.q, robot.robot.size());
    const VectorJ v = Eigen::Map<const Eigen::VectorXd>(state.v, robot.robot.size());
    model.evaluate(q, v, &terms);
    force.update(controller::read_tip(state), terms, A_BT);
    return force.F_ext();
  }
  /// Mean of the cycles up to a time.
  Vector6 mean_F_ext(double until_s) {
    Vector6 sum = Vector6::Zero();
    int count = 0;
    for (; lab.time_ns() < std::llround(until_s * 1e9); ++count) {
      lab.step();
      sum += F_ext();
      EXPECT_TRUE(force.valid());
    }
    return sum / count;
  }

  testing::TemporaryFolder folder;
  LoadedRobot robot;
  Scenario scenario;
  Lab lab;
  controller::ArmModel model;
  controller::ArmTerms terms;
  controller::TipForce force;
};

void expect_wrench(const Vector6& F, const Vector6& expected, double force_N, double torque_Nm) {
  EXPECT_LT((F - expected).head<3>().cwiseAbs().maxCoeff(), force_N) << F.transpose();
  EXPECT_LT((F - expected).tail<3>().cwiseAbs().maxCoeff(), torque_Nm) << F.transpose();
}

Vector6 pushed() {
  Vector6 F;
  F << 6, -4, 5, 0.3, -0.2, 0.1;
  return F;
}
const std::string kPush =
    "  - {at_s: 2.0, push: {force_N: [6, -4, 5], torque_Nm: [0.3, -0.2, 0.1], ramp_s: 0.2, "
    "for_s: 2.0}}\n";

// What is left is the turn of the hand by the drives' 16-bit encoders, 0.4 mrad a joint: on 9 N of
// push and 2 N of tool about 5 mN.
TEST(TipSensorInTheLab, AnIdealSensorShowsThePushAndNothingElse) {
  Stage stage(kIdeal, kPush);
  stage.run_to(1.9);
  expect_wrench(stage.mean_F_ext(2.0), Vector6::Zero(), 0.02, 0.002);
  stage.run_to(3.5);
  ASSERT_EQ(stage.lab.state().sensor_state, int{joint_state_t::SENSOR_FRESH});
  expect_wrench(stage.mean_F_ext(3.8), pushed(), 0.02, 0.002);
  expect_wrench(stage.F_ext(), pushed(), 0.03, 0.003);
}

TEST(TipSensorInTheLab, ARealisticOneShowsItWithinItsResolution) {
  Stage stage(kReal, kPush);
  stage.run_to(3.3);
  expect_wrench(stage.F_ext(), pushed(), 0.2 + 5 * 0.1, 0.008 + 5 * 0.004 + 0.04 * 0.7);
  expect_wrench(stage.mean_F_ext(3.8), pushed(), 0.05, 0.005);
}

TEST(TipSensorInTheLab, AWallShowsTheForceThatTheWallExerts) {
  Stage stage(kIdeal, "");
  stage.run_to(1.5);
  const sim_truth_t& before = stage.lab.truth();
  scenario_event_t wall{};
  wall.kind = scenario_event_t::EVENT_WALL;
  wall.normal[0] = -1.0;
  std::copy_n(before.p_BT, 3, wall.point);
  wall.point[0] -= 0.01;  // the hand is a centimetre in it
  wall.stiffness_N_per_m = 1000.0;
  wall.damping_Ns_per_m = 50.0;
  ASSERT_TRUE(stage.lab.simulator().event(wall));
  stage.run_to(3.5);
  const Vector6 truth = Eigen::Map<const Vector6>(stage.lab.truth().F_contact);
  ASSERT_LT(truth[0], -2.0);  // springs of 500 and 1000 N/m share 10 mm: 3.3 N
  expect_wrench(stage.F_ext(), truth, 0.03, 0.003);
}

// Half a second for 0.18 m is up to 4 m/s^2: the tool's 0.19 kg pull with most of a newton. The
// acceleration is that of the simulated tip over the last period; half a period is its error.
TEST(TipSensorInTheLab, TheToolsInertiaIsNoContact) {
  Stage stage(kIdeal, "  - {at_s: 2.0, goal: {offset_m: [0, 0.1, 0.15], duration_s: 0.5}}\n");
  stage.run_to(2.0);
  double most = 0.0;
  double most_uncompensated = 0.0;
  Vector6 last = Eigen::Map<const Vector6>(stage.lab.truth().V_BT);
  while (stage.lab.time_ns() < 2'600'000'000) {
    // The truth is that of the state that the next step publishes.
    const Vector6 V = Eigen::Map<const Vector6>(stage.lab.truth().V_BT);
    stage.lab.step();
    most_uncompensated = std::max(most_uncompensated, stage.F_ext().head<3>().norm());
    most = std::max(most, stage.F_ext((V - last) / 1e-3).head<3>().norm());
    last = V;
  }
  EXPECT_GT(most_uncompensated, 0.4);
  EXPECT_LT(most, 0.06);
}

template <typename Message>
std::string bytes(const Message& message) {
  std::string out(static_cast<std::size_t>(message.getEncodedSize()), '\0');
  message.encode(out.data(), 0, static_cast<int>(out.size()));
  return out;
}

TEST(TipSensorInTheLab, GivesTheSameBytesTwiceNoiseIncluded) {
  Stage first(kReal, kPush);
  Stage second(kReal, kPush);
  double largest = 0.0;
  while (first.lab.time_ns() < 2'500'000'000) {
    first.lab.step();
    second.lab.step();
    ASSERT_EQ(bytes(first.lab.state()), bytes(second.lab.state())) << first.lab.time_ns();
    largest = std::max(largest, std::abs(first.lab.state().F_sensor[0]));
  }
  EXPECT_GT(largest, 1.0);
}

TEST(TipSensorInTheLab, NeverAllocates) {
  Stage stage(kReal, kPush);
  stage.run_to(0.01);
  const std::int64_t before = allocations();
  stage.run_to(2.5);
  EXPECT_EQ(allocations() - before, 0);
}

TEST(TipSensorInTheLab, ASilentSensorIsReportedAndTheArmGoesOn) {
  Stage stage(kIdeal, "  - {at_s: 2.0, fault: {sensor: tip, kind: silent, for_s: 0.1}}\n");
  stage.run_to(2.0);
  EXPECT_EQ(stage.lab.state().sensor_state, int{joint_state_t::SENSOR_FRESH});
  stage.run_to(2.05);
  EXPECT_EQ(stage.lab.state().sensor_state, int{joint_state_t::SENSOR_ERROR});
  stage.F_ext();
  EXPECT_FALSE(stage.force.valid());
  EXPECT_EQ(stage.lab.state().drive_state, int{joint_state_t::DRIVE_ON});
  stage.run_to(2.2);
  EXPECT_EQ(stage.lab.state().sensor_state, int{joint_state_t::SENSOR_FRESH});
  // The request of the state at 2 s is on the wire when the fault begins, that of 2.1 s when it
  // ends.
  EXPECT_EQ(stage.lab.driver_status().sensor_replies_lost, 100);
}

}  // namespace
}  // namespace limber::test_tip_sensor
