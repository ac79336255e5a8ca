// The simulator as the driver meets it: frames in, frames out, time by TICKs.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "common/config_error.h"
#include "drivers/can/lockstep_frame.h"
#include "drivers/protocols/mit.h"
#include "tests/sim/simulator_bench.h"
#include "tests/sim/test_arms.h"
#include "tools/allocations/allocations.h"

namespace limber::test_simulator {
namespace {

using mit::Special;
using testing::Bench;

/// The planar arm on two buses, joint 1 on the first, joint 2 on the second.
LoadedRobot two_bus_arm() {
  LoadedRobot robot = testing::planar_arm(testing::desktop());
  robot.robot.buses.push_back({"second", "virtual:second", false, 1'000'000, 5'000'000});
  robot.robot.joints[1].drive.bus = 1;
  for (JointConfig& joint : robot.robot.joints) {
    joint.position_min = -2.6;
    joint.position_max = 2.6;
    joint.friction.viscous_Nms_per_rad = 0.03;
    joint.friction.coulomb_Nm = joint.friction.static_Nm = 0.05;
  }
  return robot;
}

SimulatorOptions reference() {
  SimulatorOptions options;
  options.integrator = Integrator::kReference;
  return options;
}

TEST(Simulator, AdvancesOnePeriodWhenEveryBusHasTicked) {
  Bench bench(two_bus_arm(), reference());
  bench.end(0).send(lockstep::tick(0));
  EXPECT_FALSE(bench.simulator().poll());
  EXPECT_EQ(bench.simulator().sim_time_ns(), 0);
  EXPECT_EQ(bench.tocks(0, 0), 0);
  bench.end(1).send(lockstep::tick(0));
  EXPECT_TRUE(bench.simulator().poll());
  EXPECT_EQ(bench.simulator().sim_time_ns(), 1'000'000);
  EXPECT_EQ(bench.tocks(0, 0), 1);
  EXPECT_EQ(bench.tocks(1, 0), 1);
}

TEST(Simulator, AnswersARepeatedTickWithoutAdvancing) {
  Bench bench(two_bus_arm(), reference());
  bench.cycle(0);
  bench.take(0);
  bench.end(0).send(lockstep::tick(0));
  EXPECT_FALSE(bench.simulator().poll());
  EXPECT_EQ(bench.tocks(0, 0), 1);
  EXPECT_EQ(bench.simulator().periods(), 1);
  EXPECT_TRUE(bench.cycle(1));
  EXPECT_EQ(bench.simulator().periods(), 2);
}

TEST(Simulator, AReadyBusWaitsForARepeatOnTheOther) {
  // The TICK of bus 1 is lost; the driver repeats it on both.
  Bench bench(two_bus_arm(), reference());
  bench.end(0).send(lockstep::tick(0));
  bench.simulator().poll();
  EXPECT_TRUE(bench.cycle(0));
  EXPECT_EQ(bench.simulator().periods(), 1);
  EXPECT_EQ(bench.tocks(0, 0), 1);
}

TEST(Simulator, AcceptsAnyNewNumber) {
  Bench bench(two_bus_arm(), reference());
  for (const std::int64_t number :
       {std::int64_t{7}, std::int64_t{0}, std::int64_t{-5}, std::int64_t{1000},
        std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::min()}) {
    EXPECT_TRUE(bench.cycle(number)) << number;
    EXPECT_EQ(bench.tocks(0, number), 1);
    EXPECT_GE(bench.simulator().truth().time_ns, 0);
  }
  EXPECT_EQ(bench.simulator().periods(), 6);
}

TEST(Simulator, EachTickAdvancesSeparately) {
  Bench bench(testing::planar_arm(testing::desktop()), reference());
  bench.tick(0);
  bench.tick(1);
  EXPECT_TRUE(bench.simulator().poll());
  EXPECT_EQ(bench.simulator().truth().seq, 1);
  EXPECT_TRUE(bench.simulator().poll());
  EXPECT_EQ(bench.simulator().truth().seq, 2);
  EXPECT_FALSE(bench.simulator().poll());
}

TEST(Simulator, RepliesLieBeforeTheTockAndShowTheStateBefore) {
  Bench bench(two_bus_arm(), reference());
  bench.send(0, Special::kEnable);
  bench.cycle(0);
  const auto frames = bench.take(0);
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[0].id, 0x11u);
  EXPECT_EQ(frames[0].data[0], 0x01);
  EXPECT_TRUE(lockstep::is_tock(frames[1]));
  bench.send(0, mit::Command{});
  bench.cycle(1);
  EXPECT_EQ(bench.take(0)[0].data[0], 0x11);
}

TEST(Simulator, NodesListenOnTheirOwnBusOnly) {
  Bench bench(two_bus_arm(), reference());
  bench.end(0).send(mit::encode_special(Special::kEnable, 2, false));
  bench.cycle(0);
  EXPECT_EQ(bench.take(0).size(), 1u);
  bench.end(1).send(mit::encode_special(Special::kEnable, 2, false));
  bench.cycle(1);
  EXPECT_EQ(bench.take(1).size(), 3u);  // the TOCK before, a reply, a TOCK
}

TEST(Simulator, CommandedTorqueMovesTheArmFromTheNextPeriodOn) {
  LoadedRobot robot = two_bus_arm();
  for (double& g : robot.robot.gravity) g = 0.0;
  SimulatorOptions options = reference();
  options.friction = false;
  options.start_q = {0.0, 1.5707963267948966};
  Bench bench(robot, options);
  bench.send(0, Special::kEnable);
  bench.cycle(0);
  EXPECT_EQ(bench.simulator().truth().v[0], 0.0);
  bench.send(0, mit::Command{0.0, 0.0, 0.0, 0.0, 1.0});
  bench.cycle(1);
  // At q2 = 90 degrees: M12 = I2 + m2 l2^2, qdd1 = tau / (M11 + B1 - M12^2 / (M22 + B2)).
  const auto s = testing::desktop();
  const double m12 = s.I2 + s.m2 * s.l2 * s.l2;
  const double m11 = s.I1 + s.m1 * s.l1 * s.l1 + s.motor * s.a1 * s.a1 + s.I2 +
                     s.m2 * (s.a1 * s.a1 + s.l2 * s.l2) + s.B1;
  const double tau = 2252 * 20.0 / 4095 - 10.0;  // 1 N m as its field has it: 2252.25, rounded
  EXPECT_NEAR(bench.simulator().truth().v[0], 1e-3 * tau / (m11 - m12 * m12 / (m12 + s.B2)), 1e-7);
  EXPECT_NEAR(bench.simulator().truth().tau_motor[0], tau, 1e-6);
}

TEST(Simulator, TruthIsExactAndConsistent) {
  Bench bench(two_bus_arm(), reference());
  for (int k = 0; k < 100; ++k) bench.cycle(k);
  const sim_truth_t& truth = bench.simulator().truth();
  EXPECT_EQ(truth.seq, 100);
  EXPECT_EQ(truth.time_ns, 100'000'000);  // arm time of this very state
  EXPECT_EQ(truth.sim_time_ns, 100'000'000);
  EXPECT_EQ(truth.num_joints, 2);
  const auto s = testing::desktop();
  const double q12 = truth.q[0] + truth.q[1];
  EXPECT_NEAR(truth.p_BT[0], s.a1 * std::cos(truth.q[0]) + s.a2 * std::cos(q12), 1e-14);
  EXPECT_NEAR(truth.p_BT[1], s.a1 * std::sin(truth.q[0]) + s.a2 * std::sin(q12), 1e-14);
  EXPECT_NEAR(
      truth.V_BT[1],
      s.a1 * std::cos(truth.q[0]) * truth.v[0] + s.a2 * std::cos(q12) * (truth.v[0] + truth.v[1]),
      1e-14);
  EXPECT_NEAR(truth.V_BT[5], truth.v[0] + truth.v[1], 1e-14);
  EXPECT_NEAR(truth.quat_BT[0], std::cos(q12 / 2), 1e-14);
  EXPECT_NEAR(truth.quat_BT[3], std::sin(q12 / 2), 1e-14);
  EXPECT_NEAR(truth.tau_friction[0] * truth.v[0], -std::abs(truth.tau_friction[0] * truth.v[0]),
              1e-12);
  EXPECT_GT(truth.work_friction_J, 0.0);
  EXPECT_EQ(truth.contact, 0);
  // Started from rest at (0, 0): energy is what it was, less friction (and a trace in the
  // bristles).
  EXPECT_NEAR(truth.kinetic_energy_J + truth.potential_energy_J, -truth.work_friction_J, 2e-5);
}

push_t push_down(double force, double duration_s) {
  push_t push{};
  push.id = 1;
  push.wrench[1] = -force;
  push.duration_s = duration_s;
  return push;
}

TEST(Simulator, TimelineActsAtItsArmTimeExactly) {
  const std::vector<TimedMessage> timeline = {{2'000'000, push_down(5.0, 0.003)},
                                              {2'000'000, mode_request_t{}},
                                              {4'500'000, scenario_event_t{}}};
  LoadedRobot robot = two_bus_arm();
  for (double& g : robot.robot.gravity) g = 0.0;
  Bench bench(robot, reference());
  bench.simulator().set_timeline(&timeline);
  for (int k = 0; k < 8; ++k) {
    bench.cycle(k);
    const sim_truth_t& truth = bench.simulator().truth();
    // TICK(2) starts the period at 2 ms; the push is over at 5 ms, when the state after TICK(4) is
    // reached.
    EXPECT_EQ(truth.F_push[1] != 0.0, k == 2 || k == 3) << k;
    EXPECT_EQ(truth.v[0] != 0.0, k >= 2) << k;
  }
  EXPECT_EQ(bench.simulator().refused(), 0);
}

TEST(Simulator, ANewSessionStartsTheTimelineOver) {
  scenario_event_t wall{};
  wall.kind = scenario_event_t::EVENT_WALL;
  wall.point[1] = 10.0;  // far above: the arm is inside
  wall.normal[1] = 1.0;
  wall.stiffness_N_per_m = 1.0;
  const std::vector<TimedMessage> timeline = {{1'000'000, wall}};
  Bench bench(two_bus_arm(), reference());
  bench.simulator().set_timeline(&timeline);
  for (const int contact : {0, 1, 1}) {
    bench.cycle(bench.simulator().periods());
    EXPECT_EQ(bench.simulator().truth().contact, contact);
  }
  for (int k = 0; k < 3; ++k) {
    bench.cycle(k);
    EXPECT_EQ(bench.simulator().truth().contact, k == 0 ? 0 : 1);
  }
}

TEST(Simulator, PushOnALinkIsReducedToTheTip) {
  SimulatorOptions options = reference();
  Bench bench(two_bus_arm(), options);
  push_t push = push_down(2.0, 1.0);
  push.link = "link1";  // its frame is the elbow in this arm: 0.3 m before the tip
  ASSERT_TRUE(bench.simulator().push(push));
  const sim_truth_t& truth = bench.simulator().truth();
  EXPECT_DOUBLE_EQ(truth.F_push[1], -2.0);
  EXPECT_NEAR(truth.F_push[5], 0.3 * 2.0, 1e-12);  // (-0.3, 0) x (0, -2)
  EXPECT_NEAR(truth.tau_external[0], -0.35 * 2.0, 1e-6);
  EXPECT_NEAR(truth.tau_external[1], 0.0, 1e-7);
}

TEST(Simulator, PushesHaveSmoothEdgesReplaceEachOtherAndEnd) {
  Bench bench(two_bus_arm(), reference());
  push_t push = push_down(8.0, 0.1);
  push.ramp_s = 0.02;
  ASSERT_TRUE(bench.simulator().push(push));
  const auto force_after = [&](int cycles) {
    for (int k = 0; k < cycles; ++k) bench.cycle(bench.simulator().periods());
    return -bench.simulator().truth().F_push[1];
  };
  EXPECT_EQ(force_after(0), 0.0);
  EXPECT_NEAR(force_after(10), 4.0, 1e-9);  // half way up
  EXPECT_NEAR(force_after(20), 8.0, 1e-9);
  push.wrench[1] = -2.0;
  ASSERT_TRUE(bench.simulator().push(push));  // same id: from 8 down to 2, no jump
  EXPECT_NEAR(force_after(0), 8.0, 1e-9);
  EXPECT_NEAR(force_after(10), 5.0, 1e-9);
  EXPECT_NEAR(force_after(20), 2.0, 1e-9);
  EXPECT_NEAR(force_after(60), 1.0, 1e-9);  // 90 ms: half way down
  EXPECT_EQ(force_after(10), 0.0);
}

TEST(Simulator, RefusesPushesThatMakeNoSense) {
  Bench bench(two_bus_arm(), reference());
  Simulator& simulator = bench.simulator();
  const auto refused = [&](auto change) {
    push_t push = push_down(1.0, 1.0);
    change(push);
    return !simulator.push(push);
  };
  EXPECT_FALSE(refused([](push_t&) {}));
  EXPECT_TRUE(refused([](push_t& p) { p.wrench[3] = NAN; }));
  EXPECT_TRUE(refused([](push_t& p) { p.wrench[0] = INFINITY; }));
  EXPECT_TRUE(refused([](push_t& p) { p.wrench[0] = 1e5; }));
  EXPECT_TRUE(refused([](push_t& p) { p.duration_s = 60.1; }));
  EXPECT_TRUE(refused([](push_t& p) { p.duration_s = 0.0; }));
  EXPECT_TRUE(refused([](push_t& p) { p.duration_s = NAN; }));
  EXPECT_TRUE(refused([](push_t& p) { p.ramp_s = 0.6; }));
  EXPECT_TRUE(refused([](push_t& p) { p.ramp_s = -0.1; }));
  EXPECT_TRUE(refused([](push_t& p) { p.link = "elbow"; }));
  for (int id = 2; id <= 8; ++id) {
    EXPECT_FALSE(refused([id](push_t& p) { p.id = id; })) << id;
  }
  EXPECT_TRUE(refused([](push_t& p) { p.id = 9; }));   // eight slots
  EXPECT_FALSE(refused([](push_t& p) { p.id = 8; }));  // one that is there
}

TEST(Simulator, RefusesEventsThatMakeNoSense) {
  Bench bench(two_bus_arm(), reference());
  const auto refused = [&](auto change) {
    scenario_event_t event{};
    event.normal[2] = 1.0;
    change(event);
    return !bench.simulator().event(event);
  };
  const auto wall = [](scenario_event_t& e) {
    e.kind = scenario_event_t::EVENT_WALL;
    e.stiffness_N_per_m = 1e4;
  };
  EXPECT_FALSE(refused(wall));
  EXPECT_TRUE(refused([&](auto& e) { wall(e), e.stiffness_N_per_m = NAN; }));
  EXPECT_TRUE(refused([&](auto& e) { wall(e), e.stiffness_N_per_m = -1.0; }));
  EXPECT_TRUE(refused([&](auto& e) { wall(e), e.damping_Ns_per_m = 1e9; }));
  EXPECT_TRUE(refused([&](auto& e) { wall(e), e.normal[2] = 0.5; }));
  EXPECT_TRUE(refused([&](auto& e) { wall(e), e.point[0] = NAN; }));
  const auto payload = [](scenario_event_t& e) {
    e.kind = scenario_event_t::EVENT_PAYLOAD;
    e.payload_mass_kg = 1.0;
  };
  EXPECT_FALSE(refused(payload));
  EXPECT_TRUE(refused([&](auto& e) { payload(e), e.payload_mass_kg = -1.0; }));
  EXPECT_TRUE(refused([&](auto& e) { payload(e), e.payload_position[1] = 2.0; }));
  const auto fault = [](scenario_event_t& e) { e.kind = scenario_event_t::EVENT_FAULT; };
  EXPECT_FALSE(refused(fault));
  EXPECT_TRUE(refused([&](auto& e) { fault(e), e.joint = 2; }));
  EXPECT_TRUE(refused([&](auto& e) { fault(e), e.joint = -1; }));
  EXPECT_TRUE(refused([&](auto& e) { fault(e), e.fault = 4; }));
  EXPECT_TRUE(refused([&](auto& e) { fault(e), e.duration_s = -1.0; }));
  EXPECT_TRUE(refused([](auto& e) { e.kind = 3; }));
}

TEST(Simulator, FaultSilencesOneNodeForItsTime) {
  Bench bench(two_bus_arm(), reference());
  scenario_event_t event{};
  event.kind = scenario_event_t::EVENT_FAULT;
  event.fault = scenario_event_t::FAULT_SILENT;
  event.joint = 1;
  event.duration_s = 0.003;
  ASSERT_TRUE(bench.simulator().event(event));
  for (int k = 0; k < 5; ++k) {
    for (const int joint : {0, 1}) bench.send(joint, mit::Command{});
    bench.cycle(k);
    EXPECT_EQ(bench.take(0).size(), 2u);
    EXPECT_EQ(bench.take(1).size(), k < 3 ? 1u : 2u) << k;
  }
}

TEST(Simulator, WatchdogCountsSimulatedTime) {
  for (const auto reaction : {NodeWatchdogReaction::kDamp, NodeWatchdogReaction::kOff}) {
    LoadedRobot robot = two_bus_arm();
    for (JointConfig& joint : robot.robot.joints) {
      joint.drive.watchdog_reaction = reaction;
      joint.drive.short_circuit_damping_Nms = 3.0;
      joint.friction = {};
    }
    Bench bench(robot, reference());
    for (const int joint : {0, 1}) {
      bench.send(joint, mit::Register::kTimeout, 100);  // 5 ms
      bench.send(joint, Special::kEnable);
    }
    for (int k = 0; k < 400; ++k) bench.cycle(k);
    bench.send(0, mit::Command{});
    bench.take(0);
    bench.simulator().poll();
    EXPECT_EQ(bench.take(0)[0].data[0], 0xD1);
    // Shorted phases lower the arm slowly: after the start, speed is gravity over damping at most.
    const double speed = std::abs(bench.simulator().truth().v[0]);
    if (reaction == NodeWatchdogReaction::kDamp) {
      EXPECT_LT(speed, 8.0 / 3.0);
    } else {
      EXPECT_GT(speed, 4.0);
    }
  }
}

TEST(Simulator, StandCarriesTheArmUntilAllDrivesAreEnabled) {
  SimulatorOptions options = reference();
  options.stand = true;
  options.start_q = {0.1, 0.2};
  Bench bench(two_bus_arm(), options);
  std::int64_t k = 0;
  const auto run = [&](int cycles) {
    for (const std::int64_t end = k + cycles; k < end; ++k) bench.cycle(k);
    return std::abs(bench.simulator().truth().q[0] - 0.1);
  };
  // The torque limit of 7 N m would move it by 2 mrad, and 7 N m of gravity do.
  EXPECT_NEAR(run(1000), 0.002, 0.0005);
  bench.send(0, Special::kEnable);
  EXPECT_LT(run(1000), 0.0025);  // one drive is not enough
  bench.send(1, Special::kEnable);
  EXPECT_LT(run(290), 0.0025);
  EXPECT_GT(run(700), 0.1);
}

TEST(Simulator, RealtimeAdvancesByWholeStepsAndIgnoresTicks) {
  SimulatorOptions options = reference();
  options.lockstep = false;
  Bench bench(two_bus_arm(), options);
  EXPECT_FALSE(bench.cycle(0));
  EXPECT_TRUE(bench.take(0).empty());
  bench.simulator().advance_to(999'999);
  EXPECT_EQ(bench.simulator().sim_time_ns(), 750'000);
  EXPECT_EQ(bench.simulator().periods(), 0);
  bench.simulator().advance_to(1'000'000);
  EXPECT_EQ(bench.simulator().periods(), 1);
}

TEST(Simulator, RealtimeTimelineWaitsForArmTime) {
  const std::vector<TimedMessage> timeline = {{10'000'000, push_down(5.0, 1.0)}};
  SimulatorOptions options = reference();
  options.lockstep = false;
  Bench bench(two_bus_arm(), options);
  Simulator& simulator = bench.simulator();
  simulator.set_timeline(&timeline);
  simulator.advance_to(100'000'000);
  EXPECT_EQ(simulator.truth().F_push[1], 0.0);
  simulator.set_arm_time_ns(4'000'000);  // the driver has started 4 ms ago
  simulator.advance_to(105'000'000);
  EXPECT_EQ(simulator.truth().F_push[1], 0.0);
  EXPECT_EQ(simulator.truth().time_ns, 9'000'000);
  simulator.advance_to(106'250'000);
  EXPECT_EQ(simulator.truth().F_push[1], -5.0);
}

TEST(Simulator, ShortensTheStepUntilItFitsThePeriod) {
  LoadedRobot robot = two_bus_arm();
  robot.robot.rate_hz = 3000.0;
  Bench bench(robot, reference());
  EXPECT_EQ(bench.simulator().next_step_ns(), 166'666);  // 333,333 ns in two steps
  bench.cycle(0);
  EXPECT_EQ(bench.simulator().sim_time_ns(), 333'333);
}

TEST(Simulator, RefusesWhatItCannotSimulate) {
  const auto refused = [](const LoadedRobot& robot, const SimulatorOptions& options) {
    MemoryBus bus;
    const auto end = bus.attach();
    try {
      Simulator simulator(robot, {end.get()}, options);
      return false;
    } catch (const ConfigError&) {
      return true;
    }
  };
  const LoadedRobot arm = testing::planar_arm(testing::desktop());
  EXPECT_FALSE(refused(arm, reference()));
  SimulatorOptions options = reference();
  options.step_s = NAN;
  EXPECT_TRUE(refused(arm, options));
  options = reference();
  options.start_q = {0.0};
  EXPECT_TRUE(refused(arm, options));
  options.start_q = {0.0, NAN};
  EXPECT_TRUE(refused(arm, options));
  options.start_q = {0.0, 1e10};
  EXPECT_TRUE(refused(arm, options));
  EXPECT_TRUE(refused(two_bus_arm(), reference()));
  LoadedRobot bare = arm;
  bare.robot.has_drives = false;
  EXPECT_TRUE(refused(bare, reference()));
  LoadedRobot lost = arm;
  lost.robot.joints[0].drive.bus = 3;
  EXPECT_TRUE(refused(lost, reference()));
}

class EitherIntegrator : public ::testing::TestWithParam<Integrator> {
 protected:
  SimulatorOptions options() const {
    SimulatorOptions out;
    out.integrator = GetParam();
    return out;
  }
};
INSTANTIATE_TEST_SUITE_P(Each, EitherIntegrator,
                         ::testing::Values(Integrator::kOde, Integrator::kReference));

void work_hard(Bench& bench, int joints, std::int64_t from, std::int64_t cycles) {
  for (std::int64_t k = from; k < from + cycles; ++k) {
    for (int joint = 0; joint < joints; ++joint) {
      const double phase = 0.01 * static_cast<double>(k) + joint;
      bench.send(joint, mit::Command{std::sin(phase), 0.0, 30.0, 1.0, 2.0 * std::cos(3.0 * phase)});
    }
    bench.cycle(k);
    CanFrame frame;
    while (bench.end(0).receive(std::span(&frame, 1)) == 1) {
    }
    bench.simulator().truth();
  }
}

TEST_P(EitherIntegrator, CyclesPushesWallsPayloadsAndFaultsDoNotAllocate) {
  const LoadedRobot robot = load_robot("openarm");
  Bench bench(robot, options());
  for (int joint = 0; joint < 7; ++joint) bench.send(joint, Special::kEnable);
  push_t push = push_down(3.0, 0.05);
  push.link = robot.segment_links[2];
  scenario_event_t wall{};
  wall.kind = scenario_event_t::EVENT_WALL;
  wall.point[2] = 0.5;
  wall.normal[2] = 1.0;
  wall.stiffness_N_per_m = 1e4;
  scenario_event_t payload{};
  payload.kind = scenario_event_t::EVENT_PAYLOAD;
  payload.payload_mass_kg = 1.0;
  scenario_event_t fault{};
  fault.kind = scenario_event_t::EVENT_FAULT;
  const std::vector<TimedMessage> timeline = {
      {20'000'000, push}, {30'000'000, wall}, {40'000'000, payload}, {50'000'000, fault}};
  bench.simulator().set_timeline(&timeline);

  const std::int64_t before = allocations();
  work_hard(bench, 7, 0, 300);
  work_hard(bench, 7, 0, 100);  // a new session
  EXPECT_EQ(allocations(), before);
  EXPECT_EQ(bench.simulator().refused(), 0);
}

TEST_P(EitherIntegrator, SameFramesGiveTheSameBytes) {
  const LoadedRobot robot = load_robot("openarm");
  std::vector<std::uint8_t> bytes[2];
  for (auto& out : bytes) {
    Bench bench(robot, options());
    for (int joint = 0; joint < 7; ++joint) bench.send(joint, Special::kEnable);
    work_hard(bench, 7, 0, 500);
    const sim_truth_t& truth = bench.simulator().truth();
    out.resize(static_cast<std::size_t>(truth.getEncodedSize()));
    truth.encode(out.data(), 0, static_cast<int>(out.size()));
  }
  EXPECT_EQ(bytes[0], bytes[1]);
}

/// Frames of all sorts, most of them addressed to somebody who listens.
CanFrame random_frame(std::mt19937_64& random, int joints) {
  CanFrame frame;
  const auto pick = [&](std::uint64_t n) { return random() % n; };
  for (std::uint8_t& byte : frame.data) byte = static_cast<std::uint8_t>(random());
  frame.length = pick(10) == 0 ? static_cast<std::uint8_t>(pick(65)) : 8;
  frame.fd = pick(2) == 0;
  frame.id = static_cast<std::uint32_t>(1 + pick(static_cast<std::uint64_t>(joints)));
  switch (pick(12)) {
    case 0:
      frame.id = static_cast<std::uint32_t>(pick(0x800));
      break;
    case 1:
      frame.id = mit::kRegisterId;
      frame.data[0] = static_cast<std::uint8_t>(1 + pick(static_cast<std::uint64_t>(joints)));
      frame.data[1] = 0;
      frame.data[2] = std::array<std::uint8_t, 4>{0x33, 0x55, 0xAA, 0xCC}[pick(4)];
      frame.data[3] = static_cast<std::uint8_t>(pick(90));
      break;
    case 2:
      return mit::encode_special(
          std::array{Special::kEnable, Special::kDisable, Special::kSetZero, Special::kClearError,
                     Special::kEnable, Special::kClearError}[pick(6)],
          frame.id, frame.fd);
    case 3:
      frame = lockstep::tick(static_cast<std::int64_t>(random()));
      break;
    case 4:
      frame.extended = true;
      frame.id = static_cast<std::uint32_t>(pick(0x20000000));
      break;
    case 5:
      (pick(2) == 0 ? frame.remote : frame.error) = true;
      break;
    default:
      break;
  }
  return frame;
}

TEST_P(EitherIntegrator, NoFramesWhateverMakeTheArmNonFinite) {
  const LoadedRobot robot = load_robot("openarm");
  Bench bench(robot, options());
  std::mt19937_64 random(42);
  std::int64_t advances = 0;
  for (int joint = 0; joint < 7; ++joint) bench.send(joint, Special::kEnable);
  for (int k = 0; k < 100'000; ++k) {
    bench.end(0).send(random_frame(random, 7));
    if (k % 8 == 0) {
      advances += bench.simulator().poll() ? 1 : 0;
      bench.take(0);
    }
    if (k % 100 == 0) {
      const sim_truth_t& truth = bench.simulator().truth();
      for (int i = 0; i < 7; ++i) {
        ASSERT_TRUE(std::isfinite(truth.q[i]) && std::isfinite(truth.v[i])) << k;
        ASSERT_LT(std::abs(truth.q[i]), 10.0) << k;  // the stops hold
      }
      ASSERT_TRUE(std::isfinite(truth.kinetic_energy_J)) << k;
    }
  }
  EXPECT_GT(advances, 5000);
  EXPECT_EQ(bench.simulator().diverged(), 0);
}

}  // namespace
}  // namespace limber::test_simulator
