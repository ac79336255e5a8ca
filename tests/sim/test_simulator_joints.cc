// Joints with springs, two motors and motors of their own as the driver meets them on the bus.
#include <gtest/gtest.h>

#include <cmath>

#include "common/config_error.h"
#include "drivers/protocols/canopen_sdo.h"
#include "drivers/protocols/cia402.h"
#include "robots/loader/protocols/drive_protocol.h"
#include "tests/sim/simulator_bench.h"
#include "tests/sim/test_arms.h"
#include "tools/allocations/allocations.h"

namespace limber::test_simulator_joints {
namespace {

using mit::Special;
using testing::Bench;

constexpr double kGravity = 1.0;  // 1 N m for the link of 4 kg at 0.25 m
constexpr double kStiffness = 100.0;
constexpr double kK2 = 400.0;
constexpr double kPreload = 0.1;
constexpr double kTorqueCount = 20.0 / 4095.0;  // of the MIT frames

SimulatorOptions options(Integrator integrator, bool stand) {
  SimulatorOptions out;
  out.integrator = integrator;
  out.stand = stand;
  return out;
}

LoadedRobot elastic_joint() {
  LoadedRobot robot = testing::one_joint(0.5, 0.2, kGravity);
  testing::make_elastic(&robot.robot.joints[0], kStiffness, 1.0);
  return robot;
}

LoadedRobot antagonistic_joint() {
  LoadedRobot robot = testing::one_joint(0.5, 0.2, kGravity);
  testing::make_antagonistic(&robot.robot.joints[0], kK2, kPreload);
  robot.robot.joints[0].transmission.damping_Nms_per_rad = 0.5;
  return robot;
}

mit::Reply reply_of(const std::vector<CanFrame>& frames, const DriveConfig& drive) {
  mit::Reply reply;
  for (const CanFrame& frame : frames) {
    if (frame.id != drive.reply_id) continue;
    EXPECT_TRUE(mit::decode_reply(frame, drive.range, &reply));
    return reply;
  }
  ADD_FAILURE() << "no reply of " << drive.reply_id;
  return reply;
}

class JointSimulator : public ::testing::TestWithParam<Integrator> {};
INSTANTIATE_TEST_SUITE_P(Each, JointSimulator,
                         ::testing::Values(Integrator::kOde, Integrator::kReference));

TEST_P(JointSimulator, ElasticJointAtTheStartCarriesItsWeightOrLiesRelaxedInTheStand) {
  for (const bool stand : {false, true}) {
    Bench bench(elastic_joint(), options(GetParam(), stand));
    const sim_truth_t& truth = bench.simulator().truth();
    EXPECT_NEAR(truth.theta[0], stand ? 0.0 : 1.0 / kStiffness, 1e-12);
    EXPECT_NEAR(truth.tau_joint[0], stand ? 0.0 : 1.0, 1e-6);
    EXPECT_NEAR(truth.elastic_energy_J, stand ? 0.0 : 0.5 / kStiffness, 1e-12);
    EXPECT_FLOAT_EQ(truth.sigma[0], static_cast<float>(kStiffness));
    EXPECT_EQ(truth.preload[0], 0.0F);
  }
}

TEST_P(JointSimulator, MotorWindsUpInTheStandAndThenCarries) {
  const LoadedRobot robot = elastic_joint();
  Bench bench(robot, options(GetParam(), true));
  bench.send(0, Special::kEnable);
  double lowest = 0.0;
  for (int k = 0; k < 2000; ++k) {
    bench.send(0, mit::Command{1.0 / kStiffness, 0.0, 50.0, 3.0, 1.0});
    bench.cycle(k);
    lowest = std::min(lowest, bench.simulator().truth().q[0]);
    if (k == 299) {  // just before the stand goes
      EXPECT_NEAR(bench.simulator().truth().tau_joint[0], 1.0, 0.05);
    }
  }
  // What counts are too coarse for is left to the motor's 50 N m/rad.
  EXPECT_GT(lowest, -2e-3);
  EXPECT_NEAR(bench.simulator().truth().q[0], 0.0, 2e-3);
}

TEST_P(JointSimulator, AntagonisticMotorsAreTwoNodesThatStartPreloaded) {
  const LoadedRobot robot = antagonistic_joint();
  Bench bench(robot, options(GetParam(), true));
  const JointConfig& joint = robot.robot.joints[0];
  const double ahead = 1.0 / (2.0 * kK2 * kPreload);  // sigma (e - q) = 1 N m
  bench.send(joint.drive, mit::Command{});
  bench.send(joint.antagonist, mit::Command{});
  bench.cycle(0);
  const auto frames = bench.take(0);
  EXPECT_NEAR(reply_of(frames, joint.drive).position_rad, kPreload + ahead, 1e-3);
  EXPECT_NEAR(reply_of(frames, joint.antagonist).position_rad, kPreload - ahead, 1e-3);
  const sim_truth_t& truth = bench.simulator().truth();
  EXPECT_NEAR(truth.theta[0], ahead, 1e-4);
  EXPECT_NEAR(truth.preload[0], kPreload, 1e-4);
  EXPECT_NEAR(truth.sigma[0], 2.0 * kK2 * kPreload, 0.1);
  EXPECT_NEAR(truth.tau_joint[0], 1.0, 2e-2);
}

TEST_P(JointSimulator, StandHoldsPreloadedMotorsUntilTheyCarry) {
  const LoadedRobot robot = antagonistic_joint();
  const JointConfig& joint = robot.robot.joints[0];
  Bench bench(robot, options(GetParam(), true));
  const double ahead = 1.0 / (2.0 * kK2 * kPreload);
  const double d1 = kPreload + ahead;
  const double d2 = kPreload - ahead;
  double furthest = 0.0;
  double loosest = kPreload;
  const auto watch = [&] {
    furthest = std::max(furthest, std::abs(bench.simulator().truth().q[0]));
    loosest = std::min<double>(loosest, bench.simulator().truth().preload[0]);
  };
  for (int k = 0; k < 300; ++k) {  // drives off: the stand alone
    bench.cycle(k);
    watch();
  }
  bench.end(0).send(mit::encode_special(Special::kEnable, joint.drive.command_id, false));
  bench.end(0).send(mit::encode_special(Special::kEnable, joint.antagonist.command_id, false));
  for (int k = 300; k < 2000; ++k) {
    bench.send(joint.drive, mit::Command{d1, 0.0, 50.0, 3.0, 0.5 * kK2 * d1 * d1});
    bench.send(joint.antagonist, mit::Command{d2, 0.0, 50.0, 3.0, 0.5 * kK2 * d2 * d2});
    bench.cycle(k);
    watch();
  }
  EXPECT_LT(furthest, 2e-3);
  EXPECT_GT(loosest, kPreload - 5e-3);
}

TEST(Simulator, FaultOfAJointIsOneOfBothItsMotors) {
  const LoadedRobot robot = antagonistic_joint();
  const JointConfig& joint = robot.robot.joints[0];
  Bench bench(robot, options(Integrator::kReference, true));
  scenario_event_t event{};
  event.kind = scenario_event_t::EVENT_FAULT;
  event.fault = scenario_event_t::FAULT_SILENT;
  event.duration_s = 0.001;
  ASSERT_TRUE(bench.simulator().event(event));
  for (const std::size_t replies : {0u, 2u}) {
    bench.take(0);
    bench.send(joint.drive, mit::Command{});
    bench.send(joint.antagonist, mit::Command{});
    bench.cycle(bench.simulator().periods());
    EXPECT_EQ(bench.take(0).size(), replies + 1);  // and the TOCK
  }
}

// The drive divides by the torque constant of robot.yaml; the motor multiplies by its own.
TEST_P(JointSimulator, ThePlantIsTheArmAndRobotYamlTheDrives) {
  LoadedRobot robot = elastic_joint();
  robot.robot.gravity[1] = 0.0;
  robot.robot.joints[0].drive.torque_constant_Nm_per_A = 0.5;
  LoadedRobot plant = robot;
  plant.robot.joints[0].drive.torque_constant_Nm_per_A = 0.4;
  plant.robot.joints[0].transmission.spring.stiffness_Nm_per_rad = 70.0;
  SimulatorOptions with = options(GetParam(), false);
  with.plant = &plant;
  Bench bench(robot, with);
  bench.send(0, Special::kEnable);
  for (int k = 0; k < 2; ++k) {
    bench.take(0);
    bench.send(0, mit::Command{0.0, 0.0, 0.0, 0.0, 1.0});
    bench.cycle(k);
  }
  EXPECT_NEAR(bench.simulator().truth().tau_motor[0], 0.8, kTorqueCount);
  EXPECT_FLOAT_EQ(bench.simulator().truth().sigma[0], 70.0F);
  bench.take(0);
  bench.send(0, mit::Command{});
  bench.simulator().poll();
  EXPECT_NEAR(reply_of(bench.take(0), robot.robot.joints[0].drive).torque_Nm, 1.0,
              2.0 * kTorqueCount);
}

TEST(Simulator, APlantWithOtherMotorsIsRefused) {
  const LoadedRobot robot = elastic_joint();
  const LoadedRobot plant = antagonistic_joint();
  SimulatorOptions with = options(Integrator::kReference, false);
  with.plant = &plant;
  EXPECT_THROW(Bench(robot, with), ConfigError);
}

// (M + B) v = tau (t - lag (1 - exp(-t / lag)))
TEST_P(JointSimulator, CurrentLoopLagsOnARigidJoint) {
  const double lag = 2e-3;
  LoadedRobot robot = testing::one_joint(0.5, 0.2, 0.0);
  robot.robot.joints[0].drive.actuator.kind = ActuatorKind::kCurrentDrive;
  robot.robot.joints[0].drive.actuator.lag_s = lag;
  Bench bench(robot, options(GetParam(), false));
  bench.send(0, Special::kEnable);
  bench.send(0, mit::Command{0.0, 0.0, 0.0, 0.0, 409.0 * kTorqueCount});
  const double tau = std::round((409.0 * kTorqueCount + 10.0) / kTorqueCount) * kTorqueCount - 10.0;
  for (int k = 0; k < 10; ++k) {
    bench.cycle(k);
    const double t = 1e-3 * (k + 1);
    const double v = tau / 0.7 * (t - lag * (1.0 - std::exp(-t / lag)));
    EXPECT_NEAR(bench.simulator().truth().v[0], v, 1e-6 * v) << k;
  }
}

LoadedRobot with_torque_loop(double rate_hz) {
  LoadedRobot robot = elastic_joint();
  robot.robot.buses[0].fd = true;
  JointConfig& joint = robot.robot.joints[0];
  joint.drive.protocol = &protocol_named("cia402");
  joint.drive.command_id = 0x201;
  joint.drive.reply_id = 0x181;
  joint.drive.rated_torque_Nm = 10.0;
  joint.torque_sensor.present = true;
  joint.torque_loop.inertia_ratio = 4.0;
  joint.torque_loop.rate_hz = rate_hz;
  return robot;
}

TEST(Simulator, StepsFitPeriodAndTorqueLoop) {
  const SimulatorOptions any = options(Integrator::kReference, false);
  EXPECT_EQ(Bench(with_torque_loop(4000.0), any).simulator().next_step_ns(), 250'000);
  EXPECT_EQ(Bench(with_torque_loop(8000.0), any).simulator().next_step_ns(), 125'000);
  EXPECT_EQ(Bench(with_torque_loop(3000.0), any).simulator().next_step_ns(), 166'666);
  EXPECT_THROW(Bench(with_torque_loop(1234.567), any), ConfigError);
}

/// What the drive says of the torque on the link after one period, N m.
double sensed_torque(bool stand) {
  Bench bench(with_torque_loop(4000.0), options(Integrator::kReference, stand));
  bench.cycle(0);
  bench.end(0).send(canopen::encode_sdo_read(cia402::kTorqueActual.id, 1));
  bench.simulator().poll();
  canopen::SdoMessage answer;
  for (const CanFrame& frame : bench.take(0)) {
    if (!canopen::decode_sdo_answer(frame, 1, &answer)) continue;
    return 10.0 * static_cast<std::int16_t>(answer.value) / 1000.0;
  }
  ADD_FAILURE() << "no answer";
  return 0.0;
}

TEST(Simulator, TorqueSensorReadsTheSpring) {
  EXPECT_NEAR(sensed_torque(true), 0.0, 0.011);  // relaxed in the stand; counts of 10 mN m
  EXPECT_NEAR(sensed_torque(false), 1.0, 0.011);
}

TEST_P(JointSimulator, CyclesDoNotAllocate) {
  LoadedRobot robot = testing::planar_arm(testing::desktop());
  testing::make_elastic(&robot.robot.joints[0], 300.0, 0.5);
  testing::make_antagonistic(&robot.robot.joints[1], kK2, kPreload);
  robot.robot.joints[0].drive.actuator.kind = ActuatorKind::kCurrentDrive;
  for (JointConfig& joint : robot.robot.joints) {
    joint.friction = {0.1, 0.12, 0.05, 0.01, 1e-4};
    joint.link_friction = joint.friction;
  }
  Bench bench(robot, options(GetParam(), true));
  const auto work = [&](int from, int to) {
    for (int k = from; k < to; ++k) {
      for (const JointConfig& joint : robot.robot.joints) {
        bench.send(joint.drive, mit::Command{0.1, 0.0, 5.0, 1.0, 0.5});
        if (joint.has_antagonist) bench.send(joint.antagonist, mit::Command{});
      }
      bench.cycle(k);
      CanFrame frame;
      while (bench.end(0).receive(std::span(&frame, 1)) == 1) {
      }
      bench.simulator().truth();
    }
  };
  work(0, 10);
  const std::int64_t before = allocations();
  work(10, 300);
  EXPECT_EQ(allocations(), before);
}

}  // namespace
}  // namespace limber::test_simulator_joints
