// Spring laws and transmissions by their equations and by published points.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/joints/transmission.h"

namespace limber::sim::test_spring {
namespace {

SpringConfig spring(SpringLaw law) {
  SpringConfig out;
  out.law = law;
  out.stiffness_Nm_per_rad = 300.0;
  out.k2_Nm_per_rad2 = 400.0;
  out.k3_Nm_per_rad3 = 5000.0;
  out.force_Nm = 2.0;
  out.rate_per_rad = 7.0;
  return out;
}

TransmissionConfig transmission(TransmissionKind kind, const SpringConfig& spring) {
  TransmissionConfig out;
  out.kind = kind;
  out.spring = spring;
  return out;
}

class EachLaw : public ::testing::TestWithParam<SpringLaw> {};
INSTANTIATE_TEST_SUITE_P(Springs, EachLaw,
                         ::testing::Values(SpringLaw::kLinear, SpringLaw::kQuadratic,
                                           SpringLaw::kCubic, SpringLaw::kExponential,
                                           SpringLaw::kSinh));

TEST_P(EachLaw, StiffnessAndTorqueAreDerivatives) {
  const double h = 1e-5;
  for (const bool pull_only : {false, true}) {
    const Spring f(spring(GetParam()), pull_only);
    for (const double d : {-0.31, -0.02, 0.03, 0.2, 0.44}) {
      const double slope = (f.torque(d + h) - f.torque(d - h)) / (2.0 * h);
      EXPECT_NEAR(f.stiffness(d), slope, 1e-6 * (1.0 + slope)) << d;
      const double gradient = (f.energy(d + h) - f.energy(d - h)) / (2.0 * h);
      EXPECT_NEAR(f.torque(d), gradient, 1e-6 * (1.0 + std::abs(gradient))) << d;
    }
  }
}

TEST_P(EachLaw, OddOrSlackOnTheOtherSide) {
  const Spring odd(spring(GetParam()), false);
  const Spring tendon(spring(GetParam()), true);
  EXPECT_GT(odd.torque(0.1), 0.0);
  EXPECT_EQ(odd.torque(-0.1), -odd.torque(0.1));
  EXPECT_EQ(odd.stiffness(-0.1), odd.stiffness(0.1));
  EXPECT_EQ(odd.energy(-0.1), odd.energy(0.1));
  EXPECT_EQ(tendon.torque(0.1), odd.torque(0.1));
  EXPECT_EQ(tendon.torque(-0.1), 0.0);
  EXPECT_EQ(tendon.stiffness(-0.1), 0.0);
  EXPECT_EQ(tendon.energy(-0.1), 0.0);
}

TEST(Spring, TorquesByHand) {
  EXPECT_NEAR(Spring(spring(SpringLaw::kLinear), false).torque(0.1), 30.0, 1e-12);
  EXPECT_NEAR(Spring(spring(SpringLaw::kQuadratic), false).torque(0.1), 2.0, 1e-12);
  EXPECT_NEAR(Spring(spring(SpringLaw::kCubic), false).torque(0.1), 35.0, 1e-12);
  EXPECT_NEAR(Spring(spring(SpringLaw::kExponential), false).torque(0.1),
              2.0 * (std::exp(0.7) - 1.0), 1e-12);
  EXPECT_NEAR(Spring(spring(SpringLaw::kSinh), false).torque(0.1), std::exp(0.7) - std::exp(-0.7),
              1e-12);
}

/// Torque on the link and stiffness of an antagonistic pair.
struct Pair {
  Transmission transmission;

  double torque(double theta1, double theta2, double q) const {
    return transmission.torque(theta1 - q, 0.0) - transmission.torque(theta2 + q, 0.0);
  }
  double stiffness(double theta1, double theta2, double q) const {
    return transmission.stiffness(theta1 - q) + transmission.stiffness(theta2 + q);
  }
};

Pair pair(const SpringConfig& spring) {
  return {Transmission(transmission(TransmissionKind::kAntagonistic, spring))};
}

// qbmove advanced: 2 k cosh(a preset) sinh(a deflection), the link behind its equilibrium.
TEST(Antagonistic, HyperbolicSpringsAsPublished) {
  SpringConfig config;
  config.law = SpringLaw::kSinh;
  config.force_Nm = 0.0019;
  config.rate_per_rad = 8.9992;
  const Pair qbmove = pair(config);
  const double points[][4] = {{0.0, 0.0, 0.0, 0.03419696},
                              {0.0, 0.2, 0.011178373, 0.106250039},
                              {0.2, 0.1, 0.012118328, 0.15225676},
                              {0.4, 0.1, 0.071403025, 0.897119866},
                              {0.5, -0.2, -0.502983446, 4.780839781}};
  for (const auto& [preset, deflection, torque, stiffness] : points) {
    EXPECT_NEAR(qbmove.torque(preset, preset, -deflection), torque, 1e-8);
    EXPECT_NEAR(qbmove.stiffness(preset, preset, -deflection), stiffness, 1e-8);
  }
}

// Tendons 100 N (exp(20 x / m) - 1) on radii of 0.02 m (motor) and 0.05 m (joint).
TEST(Antagonistic, ExponentialTendonsAsPublished) {
  SpringConfig config;
  config.law = SpringLaw::kExponential;
  config.force_Nm = 100.0 * 0.05;
  config.rate_per_rad = 20.0 * 0.05;
  const Pair tendons = pair(config);
  const double gear = 0.02 / 0.05;
  const double points[][5] = {{1.0, 1.0, 0.0, 0.0, 14.918246976},
                              {2.0, 1.0, 0.0, 3.668581154, 18.586828131},
                              {2.0, 2.0, 0.3, -6.777223766, 23.264436473},
                              {0.2, 0.2, 0.3, -2.311422947, 7.311422947}};
  for (const auto& [theta1, theta2, q, torque, stiffness] : points) {
    EXPECT_NEAR(tendons.torque(gear * theta1, gear * theta2, q), torque, 1e-8);
    EXPECT_NEAR(tendons.stiffness(gear * theta1, gear * theta2, q), stiffness, 1e-8);
  }
}

// F = k x^2 on a radius r: k2 = 2 k r^3. The last point has one spring slack.
TEST(Antagonistic, QuadraticSpringsAsPublished) {
  SpringConfig config;
  config.law = SpringLaw::kQuadratic;
  config.k2_Nm_per_rad2 = 2.0 * 4e5 * std::pow(0.02, 3);
  const Pair springs = pair(config);
  const double points[][4] = {{0.5, 0.0, 0.0, 6.4},
                              {0.5, 0.2, 1.28, 6.4},
                              {1.0, 0.2, 2.56, 12.8},
                              {1.0, -0.9, -11.52, 12.8},
                              {0.5, 0.8, 5.408, 8.32}};
  for (const auto& [preset, deflection, torque, stiffness] : points) {
    EXPECT_NEAR(springs.torque(preset, preset, -deflection), torque, 1e-9);
    EXPECT_NEAR(springs.stiffness(preset, preset, -deflection), stiffness, 1e-9);
  }
}

TEST(Transmission, DamperIsInParallelToTheSpring) {
  TransmissionConfig config = transmission(TransmissionKind::kElastic, spring(SpringLaw::kLinear));
  config.damping_Nms_per_rad = 4.0;
  const Transmission elastic(config);
  EXPECT_NEAR(elastic.torque(0.01, 0.5), 3.0 + 2.0, 1e-12);
  EXPECT_NEAR(elastic.torque(0.01, -5.0), 3.0 - 20.0, 1e-12);
  EXPECT_NEAR(elastic.torque(0.0, 1.0), 4.0, 1e-12);
}

TEST(Transmission, TendonNeverPushes) {
  TransmissionConfig config =
      transmission(TransmissionKind::kAntagonistic, spring(SpringLaw::kQuadratic));
  config.damping_Nms_per_rad = 4.0;
  const Transmission tendon(config);
  EXPECT_NEAR(tendon.torque(0.1, -0.1), 2.0 - 0.4, 1e-12);
  EXPECT_EQ(tendon.torque(0.1, -1.0), 0.0);
  EXPECT_EQ(tendon.torque(-0.1, 1.0), 0.0);
  EXPECT_EQ(tendon.damping(-0.1), 0.0);
}

TEST(Transmission, BacklashIsADeadZoneOfItsFullWidth) {
  TransmissionConfig config = transmission(TransmissionKind::kElastic, spring(SpringLaw::kLinear));
  config.damping_Nms_per_rad = 4.0;
  config.backlash_rad = 0.02;
  const Transmission loose(config);
  for (const double d : {-0.0099, 0.0, 0.0099}) {
    EXPECT_EQ(loose.torque(d, 1.0), 0.0);
    EXPECT_EQ(loose.stiffness(d), 0.0);
    EXPECT_EQ(loose.energy(d), 0.0);
  }
  EXPECT_NEAR(loose.torque(0.02, 0.0), 3.0, 1e-12);
  EXPECT_NEAR(loose.torque(-0.02, 0.0), -3.0, 1e-12);
  EXPECT_NEAR(loose.energy(0.02), 0.015, 1e-12);
  EXPECT_EQ(loose.torque(0.02, -1.0), 0.0) << "a face that is left does not stick";
}

TEST_P(EachLaw, DeflectionCarriesTheTorqueAskedFor) {
  for (const double torque : {-3.0, 0.0, 0.4, 50.0}) {
    TransmissionConfig config = transmission(TransmissionKind::kElastic, spring(GetParam()));
    config.backlash_rad = 0.01;
    const Transmission elastic(config);
    EXPECT_NEAR(elastic.torque(elastic.deflection(torque, 0.0), 0.0), torque, 1e-9);
    config = transmission(TransmissionKind::kAntagonistic, spring(GetParam()));
    const Pair two{Transmission(config)};
    const double ahead = two.transmission.deflection(torque, 0.2);
    EXPECT_NEAR(two.torque(0.2 + ahead, 0.2 - ahead, 0.0), torque, 1e-9);
  }
}

}  // namespace
}  // namespace limber::sim::test_spring
