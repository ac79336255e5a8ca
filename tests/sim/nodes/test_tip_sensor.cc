// The simulated force/torque sensor: what it feels in states written down by hand, and what its
// electronics make of it.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "drivers/protocols/limber_ft.h"
#include "drivers/protocols/robotous_rft.h"
#include "sim/nodes/tip_sensor_node.h"
#include "sim/plant/tip_load.h"
#include "sim/world/world_event.h"
#include "tests/sim/test_arms.h"

namespace limber::sim::test_tip_sensor {
namespace {

constexpr double kGravity = 9.81;  // along base -y

Vector6 six(double a, double b, double c, double d, double e, double f) {
  Vector6 v;
  v << a, b, c, d, e, f;
  return v;
}

void expect_near(const Vector6& F, const Vector6& expected, double tolerance) {
  EXPECT_LT((F - expected).cwiseAbs().maxCoeff(), tolerance)
      << F.transpose() << "\nexpected " << expected.transpose();
}

// --- what it feels: the planar arm of 0.35 and 0.3 m, stretched along base x unless turned -------

struct Felt : ::testing::Test {
  Felt() : arm(build_arm_model(testing::planar_arm(testing::desktop()))) { place(0.0, 0.0); }

  void place(double q1, double v1) {
    VectorJ q(2), v(2);
    q << q1, 0.0;
    v << v1, 0.0;
    arm.set_state(q, v);
  }
  void push(int link, const Vector6& F) {
    Push one;
    one.link = link;
    one.wrench = F;
    one.duration_ns = 1'000'000'000;
    ASSERT_TRUE(environment.pushes.add(one, 0));
  }
  /// Standing still.
  Vector6 felt() {
    TipLoad load(config, arm);
    load.step(arm, environment, 1e-3, 500'000'000);
    return load.F();
  }

  LinkDynamics arm;
  Environment environment;
  TipSensorConfig config;
};

TEST_F(Felt, TheToolsWeight) {
  config.tool_mass_kg = 0.5;
  config.p_SC[0] = 0.1;
  expect_near(felt(), six(0, -0.5 * kGravity, 0, 0, 0, -0.05 * kGravity), 1e-12);
  place(M_PI / 2, 0.0);  // arm upwards: the weight along sensor -x, through the sensor's axis
  expect_near(felt(), six(-0.5 * kGravity, 0, 0, 0, 0, 0), 1e-12);
}

// A push of 2 N along y at the tip, sensor 0.1 m behind it: moment 0.1 * 2 about z, and the push's
// own 0.3 N m about x. The sensor's x axis points along tip y, its y along tip -x.
TEST_F(Felt, APushOnTheTipLinkInItsOwnAxes) {
  config.p_TS[0] = -0.1;
  const double half = std::sqrt(0.5);
  config.quat_TS[0] = half;
  config.quat_TS[3] = half;
  push(arm.tip(), six(0, 2, 0, 0.3, 0, 0));
  expect_near(felt(), six(2, 0, 0, 0, -0.3, 0.2), 1e-12);
}

TEST_F(Felt, NothingOfAPushOnAnotherLink) {
  push(0, six(5, 5, 5, 1, 1, 1));
  expect_near(felt(), Vector6::Zero(), 1e-12);
}

// A wall across base x whose face is 2 mm before the tip: 2000 N/m * 2 mm against the arm.
TEST_F(Felt, TheWall) {
  environment.wall.point = {0.65 - 0.002, 0.0, 0.0};
  environment.wall.normal = {-1.0, 0.0, 0.0};
  environment.wall.stiffness = 2000.0;
  expect_near(felt(), six(-4, 0, 0, 0, 0, 0), 1e-9);
}

// Turning at 3 rad/s the tool, 0.65 + 0.1 m out, pulls with m omega^2 r; the mean over a step of 1
// us differs by half its angle.
TEST_F(Felt, CentrifugalForce) {
  const double h = 1e-6, omega = 3.0;
  config.tool_mass_kg = 0.5;
  config.p_SC[0] = 0.1;
  place(0.0, omega);
  TipLoad load(config, arm);
  place(omega * h, omega);
  load.step(arm, environment, h, 0);
  const double pull = 0.5 * omega * omega * 0.75;
  expect_near(load.F(), six(pull, -0.5 * kGravity, 0, 0, 0, -0.05 * kGravity), 5e-5);
}

// From rest to alpha h in h: the tool lags behind with m alpha r.
TEST_F(Felt, AngularAcceleration) {
  const double h = 1e-6, alpha = 20.0;
  config.tool_mass_kg = 0.5;
  config.p_SC[0] = 0.1;
  TipLoad load(config, arm);
  place(0.0, alpha * h);
  load.step(arm, environment, h, 0);
  const double f = -0.5 * (kGravity + alpha * 0.75);
  expect_near(load.F(), six(0, f, 0, 0, 0, 0.1 * f), 1e-6);
}

TEST_F(Felt, APayloadThatNobodyToldIt) {
  TipLoad load(config, arm);
  place(0.0, 1.0);
  load.set_payload(arm, 2.0, {0.0, 0.0, 0.05});
  load.step(arm, environment, 1e-3, 0);  // no step of its velocity, whatever the arm's is
  expect_near(load.F(), six(0, -2 * kGravity, 0, 0.1 * kGravity, 0, 0), 1e-12);
  load.set_payload(arm, 0.0, Eigen::Vector3d::Zero());
  load.step(arm, environment, 1e-3, 0);
  expect_near(load.F(), Vector6::Zero(), 1e-12);
}

// --- what the electronics make of it -------------------------------------------------------------

TipSensorConfig ideal() {
  TipSensorConfig config;
  config.protocol = TipSensorProtocol::kLimberFt;
  config.command_id = 0x54;
  config.reply_ids = {0x55, 0};
  config.range = {100, 100, 100, 5, 5, 5};
  return config;
}

WrenchReading ask(TipSensorNode* node) {
  WrenchReading reading;
  std::uint8_t counter = 0;
  const std::span<const CanFrame> answer = node->receive(limber_ft::encode_request(0x54, 9));
  EXPECT_EQ(answer.size(), 1U);
  if (answer.empty()) return reading;
  EXPECT_EQ(answer[0].id, 0x55U);
  EXPECT_TRUE(limber_ft::decode_reply(answer[0], &counter, &reading));
  EXPECT_EQ(counter, 9);
  return reading;
}

TEST(TipSensorNode, SaysWhatItFeels) {
  TipSensorNode node(ideal());
  node.update(six(1, -2, 3, 0.5, -0.25, 0.125), 1e-3, 0);
  const SixAxes expected = {1, -2, 3, 0.5, -0.25, 0.125};
  EXPECT_EQ(ask(&node).F, expected);
  EXPECT_EQ(ask(&node).overload, 0);
}

TEST(TipSensorNode, AnswersNobodyElse) {
  TipSensorNode node(ideal());
  EXPECT_TRUE(node.receive(limber_ft::encode_request(0x53, 0)).empty());
  EXPECT_TRUE(node.receive(robotous_rft::encode_request(0x54)).empty());
}

TEST(TipSensorNode, SpeaksRobotousRft) {
  TipSensorConfig config = ideal();
  config.protocol = TipSensorProtocol::kRobotousRft;
  config.reply_ids = {1, 2};
  TipSensorNode node(config);
  node.update(six(10, 0, 0, 1, 0, 0), 1e-3, 0);
  const auto answer = node.receive(robotous_rft::encode_request(0x54));
  ASSERT_EQ(answer.size(), 2U);
  WrenchReading reading;
  ASSERT_TRUE(robotous_rft::decode_reply(answer[0], answer[1], {}, &reading));
  EXPECT_EQ(answer[0].id, 1U);
  EXPECT_EQ(answer[1].id, 2U);
  EXPECT_EQ(reading.F[0], 10.0);
  EXPECT_EQ(reading.F[3], 1.0);
}

// A first-order low-pass answers a step with 1 - exp(-t / tau), whatever the sampling.
TEST(TipSensorNode, FilterIsFirstOrder) {
  TipSensorConfig config = ideal();
  config.filter_time_constant_s = 0.004;
  for (const double h : {0.00025, 0.001, 0.01}) {
    TipSensorNode node(config);
    node.update(Vector6::Zero(), h, 0);
    for (int k = 1; k <= 10; ++k) {
      node.update(Vector6::Constant(2.0), h, 0);
      EXPECT_NEAR(ask(&node).F[0], 2.0 * (1.0 - std::exp(-k * h / 0.004)), 1e-6) << h << " " << k;
    }
  }
}

TEST(TipSensorNode, BiasResolutionAndRange) {
  TipSensorConfig config = ideal();
  config.bias = {0.5, 0, 0, 0, 0, 0};
  config.resolution = {0.2, 0.2, 0.2, 0, 0, 0};
  TipSensorNode node(config);
  node.update(six(1.16, -0.29, 150.0, 0.123, 0, -6), 1e-3, 0);
  const WrenchReading reading = ask(&node);
  EXPECT_NEAR(reading.F[0], 1.6, 1e-6);   // 1.66
  EXPECT_NEAR(reading.F[1], -0.2, 1e-6);  // -0.29
  EXPECT_NEAR(reading.F[2], 100.0, 1e-6);
  EXPECT_NEAR(reading.F[3], 0.123, 1e-6);
  EXPECT_NEAR(reading.F[5], -5.0, 1e-6);
  EXPECT_EQ(reading.overload, overload_bit(2) | overload_bit(5));
}

TEST(TipSensorNode, NoiseHasTheStatedDeviationAndNoMean) {
  TipSensorConfig config = ideal();
  config.noise = {0.3, 0.3, 0, 0, 0, 0};
  TipSensorNode node(config);
  constexpr int kSamples = 20'000;
  double sum = 0.0, squares = 0.0, product = 0.0, successive = 0.0, last = 0.0;
  for (int k = 0; k < kSamples; ++k) {
    node.update(Vector6::Zero(), 1e-3, k * 1'000'000LL);
    const SixAxes F = ask(&node).F;
    sum += F[0];
    squares += F[0] * F[0];
    product += F[0] * F[1];
    successive += F[0] * last;
    last = F[0];
    ASSERT_EQ(F[2], 0.0);
  }
  // Five standard errors: of a mean sigma / sqrt(N), of a variance sigma^2 sqrt(2 / N).
  const double root = std::sqrt(kSamples);
  EXPECT_NEAR(sum / kSamples, 0.0, 5 * 0.3 / root);
  EXPECT_NEAR(squares / kSamples, 0.09, 5 * 0.09 * M_SQRT2 / root);
  EXPECT_NEAR(product / kSamples, 0.0, 5 * 0.09 / root);
  EXPECT_NEAR(successive / kSamples, 0.0, 5 * 0.09 / root);
}

TEST(TipSensorNode, NoiseFollowsSeedAndTimeAlone) {
  TipSensorConfig config = ideal();
  config.noise.fill(0.1);
  TipSensorNode asked_often(config);
  TipSensorNode asked_once(config);
  config.noise_seed = 2;
  TipSensorNode other(config);
  for (TipSensorNode* node : {&asked_often, &asked_once, &other})
    node->update(Vector6::Zero(), 1e-3, 5'000'000);
  const SixAxes F = ask(&asked_often).F;
  EXPECT_EQ(ask(&asked_often).F, F);
  EXPECT_EQ(ask(&asked_once).F, F);
  EXPECT_NE(ask(&other).F, F);
}

TEST(TipSensorFault, IsTakenOnlyWhereThereIsASensorAndOnlySilence) {
  scenario_event_t event{};
  event.kind = scenario_event_t::EVENT_FAULT;
  event.joint = scenario_event_t::NODE_TIP_SENSOR;
  event.duration_s = 0.5;
  NodeFault fault;
  EXPECT_FALSE(read_fault(event, {2, false, true}, &fault));
  ASSERT_TRUE(read_fault(event, {2, true, false}, &fault));
  EXPECT_EQ(fault.joint, int{scenario_event_t::NODE_TIP_SENSOR});
  EXPECT_EQ(fault.duration_ns, 500'000'000);
  event.fault = scenario_event_t::FAULT_FROZEN_ENCODER;
  EXPECT_FALSE(read_fault(event, {2, true, false}, &fault));
}

TEST(TipSensorNode, FallsSilentForATime) {
  TipSensorNode node(ideal());
  node.update(Vector6::Zero(), 1e-3, 1'000'000);
  node.silence(3'000'000);
  EXPECT_TRUE(node.receive(limber_ft::encode_request(0x54, 0)).empty());
  node.update(Vector6::Zero(), 1e-3, 3'000'000);
  EXPECT_FALSE(node.receive(limber_ft::encode_request(0x54, 0)).empty());
}

}  // namespace
}  // namespace limber::sim::test_tip_sensor
