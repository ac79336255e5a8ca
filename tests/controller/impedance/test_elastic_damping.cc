// Damping of a link behind a spring, against closed forms and a sampled joint that knows nothing of
// the design.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "controller/impedance/damping_check.h"
#include "controller/impedance/elastic_damping.h"

namespace limber::controller::test_elastic_damping {
namespace {

constexpr double kAny = 1e9;
constexpr double kT = 1e-3;

double rigid(const ElasticMode& m, double K, double ratio) {
  return 2.0 * ratio * std::sqrt(K * (m.link + m.rotor));
}

// zeta_max = (sqrt(1 + K_J / k) - 1) / 2.
TEST(ElasticDamping, OfAMotorWithoutMassIsAtMostTheClosedForm) {
  for (const double k : {500.0, 1000.0, 4000.0}) {
    const ElasticMode mode{.link = 0.5, .rotor = 0.0, .spring = 1500.0, .law = k};
    const double most = 0.5 * (std::sqrt(1.0 + 1500.0 / k) - 1.0);
    const double hard = elastic_damping(mode, 0.9, rigid(mode, k, 0.9), kAny, 0.0).ratio;
    EXPECT_NEAR(hard, most, 0.02 * most) << k;
    const double easy = 0.9 * most;
    const ElasticDamping met = elastic_damping(mode, easy, rigid(mode, k, easy), kAny, 0.0);
    EXPECT_NEAR(met.ratio, easy, 1e-9);
    // The pair s^2 + 2 z w s + w^2 times (s + a) is the polynomial: its ratio, from D alone.
    const double D = met.D;
    const std::array<double, 3> c{0.5 * (1500.0 + k) / (0.5 * D), 1500.0 / 0.5,
                                  1500.0 * k / (0.5 * D)};
    double a = c[0];
    for (int i = 0; i < 200; ++i) {
      a -= (((a - c[0]) * a + c[1]) * a - c[2]) / ((3.0 * a - 2.0 * c[0]) * a + c[1]);
    }
    const double w = std::sqrt(c[2] / a);
    EXPECT_NEAR(0.5 * (c[0] - a) / w, easy, 0.004) << k;
  }
}

TEST(ElasticDamping, OfAStiffSpringIsThatOfARigidJoint) {
  for (const PositionFeedback position :
       {PositionFeedback::kMotor, PositionFeedback::kStatic, PositionFeedback::kLink}) {
    for (const double ratio : {0.1, 0.3, 0.7, 1.0, 1.5}) {
      const ElasticMode mode{.link = 0.5,
                             .rotor = 0.2,
                             .spring = 1e8,
                             .law = law_stiffness(position, 500.0, 1e-8),
                             .at_link = position == PositionFeedback::kLink};
      const double D = rigid(mode, 500.0, ratio);
      EXPECT_NEAR(elastic_damping(mode, ratio, D, kAny, 0.0).D, D, 0.01 * D) << ratio;
    }
  }
}

TEST(ElasticDamping, LawStiffnessOfEachPosition) {
  EXPECT_EQ(law_stiffness(PositionFeedback::kMotor, 500.0, 1e-3), 500.0);
  EXPECT_EQ(law_stiffness(PositionFeedback::kLink, 500.0, 1e-3), 500.0);
  EXPECT_DOUBLE_EQ(law_stiffness(PositionFeedback::kStatic, 500.0, 1e-3), 1000.0);
}

// No jump on the way of a gain ramp, nor where the design goes over into the rigid one.
TEST(ElasticDamping, IsContinuousInStiffnessAndRatio) {
  const auto damping = [](double share, double ratio) {
    const double K = 1000.0 * share;
    const ElasticMode mode{.link = 0.5,
                           .rotor = 0.2,
                           .spring = 1000.0,
                           .damper = 2.0,
                           .law = law_stiffness(PositionFeedback::kStatic, K, 1e-3)};
    return elastic_damping(mode, ratio, rigid(mode, K, ratio), 0.5 * 0.2 / kT, 1.5 * kT).D;
  };
  for (const double ratio : {0.1, 0.3, 0.7}) {
    double before = damping(0.01, ratio);
    for (double share = 0.011; share < 0.94; share += 0.001) {
      const double D = damping(share, ratio);
      EXPECT_NEAR(D, before, 0.8 + 0.06 * before) << ratio << " " << share;
      before = D;
    }
  }
  for (const double share : {0.05, 0.3, 0.5, 0.7}) {
    double before = damping(share, 0.02);
    for (double ratio = 0.021; ratio < 0.75; ratio += 0.001) {
      const double D = damping(share, ratio);
      EXPECT_NEAR(D, before, 0.8 + 0.06 * before) << ratio << " " << share;
      before = D;
    }
  }
}

TEST(ElasticDamping, NeverExceedsWhatItMay) {
  const ElasticMode mode{.link = 0.5, .rotor = 0.2, .spring = 1000.0, .law = 9000.0};
  for (const double most : {0.0, 1.0, 30.0}) {
    EXPECT_LE(elastic_damping(mode, 0.7, 35.0, most, 1.5 * kT).D, most);
  }
  const ElasticMode none{.link = 0.5, .rotor = 0.2, .spring = 1000.0, .law = 0.0};
  EXPECT_EQ(elastic_damping(none, 0.7, 0.0, kAny, 1.5 * kT).D, 0.0);
}

// The joint as it is: torque a cycle late and held, the motor's torque loop without delay.
struct Joint {
  const char* name;
  double K_J, D_J, B;
  PositionFeedback position;
  double K, ratio;
};

class SampledJoint {
 public:
  SampledJoint(const Joint& joint, double D) : joint_(joint), D_(D) {
    const bool link = joint.position == PositionFeedback::kLink;
    k_ = law_stiffness(joint.position, joint.K, 1.0 / joint.K_J);
    const double force = 1.0;
    q_ = link ? force / k_ : force / k_ + force / joint.K_J;
    theta_ = q_ - force / joint.K_J;
    late_ = -force;
  }
  // How far the link, let go, swings through, over where it came from; more than 1: it grows.
  double overshoot(double seconds) {
    const double start = q_;
    double least = 0.0;
    for (int i = 0; i < static_cast<int>(seconds / kT); ++i) {
      cycle();
      least = std::min(least, q_);
    }
    return -least / start;
  }
  double left() const { return std::abs(q_) + std::abs(theta_); }

 private:
  void cycle() {
    const double x = joint_.position == PositionFeedback::kLink ? q_ : theta_;
    const double next = -k_ * x - D_ * theta_dot_;
    constexpr int kParts = 200;
    for (int i = 0; i < kParts; ++i) {
      const double h = kT / kParts;
      const double tau = joint_.K_J * (theta_ - q_) + joint_.D_J * (theta_dot_ - v_);
      v_ += h * tau / kLink;
      theta_dot_ += h * (late_ - tau) / joint_.B;
      q_ += h * v_;
      theta_ += h * theta_dot_;
    }
    late_ = next;
  }

  static constexpr double kLink = 0.5;
  Joint joint_;
  double D_, k_, q_, theta_, late_;
  double v_ = 0.0;
  double theta_dot_ = 0.0;
};

double designed(const Joint& joint, double* ratio) {
  const ElasticMode mode{.link = 0.5,
                         .rotor = joint.B,
                         .spring = joint.K_J,
                         .damper = joint.D_J,
                         .law = law_stiffness(joint.position, joint.K, 1.0 / joint.K_J),
                         .at_link = joint.position == PositionFeedback::kLink};
  const ElasticDamping found = elastic_damping(mode, joint.ratio, rigid(mode, joint.K, joint.ratio),
                                               0.5 * joint.B / kT, 1.5 * kT);
  *ratio = found.ratio;
  return found.D;
}

class Sampled : public ::testing::TestWithParam<Joint> {};

TEST_P(Sampled, OvershootsAsAskedOrAsIsPossible) {
  double ratio = 0.0;
  const double D = designed(GetParam(), &ratio);
  SampledJoint joint(GetParam(), D);
  const double seen = joint.overshoot(2.0);
  EXPECT_LT(seen, overshoot(ratio) + 0.03);
  // Where less than asked is possible, the other roots are not much faster, and brake.
  const bool met = ratio > GetParam().ratio - 1e-9;
  EXPECT_GT(seen, overshoot(ratio) - (met ? 0.03 : 0.06));
  EXPECT_LT(ratio, GetParam().ratio + 1e-9);
}
constexpr PositionFeedback kMotor = PositionFeedback::kMotor;
constexpr PositionFeedback kStatic = PositionFeedback::kStatic;
constexpr PositionFeedback kLink = PositionFeedback::kLink;
INSTANTIATE_TEST_SUITE_P(
    Joints, Sampled,
    ::testing::Values(Joint{"flexible", 1500, 2, 0.2, kMotor, 500, 0.3},
                      Joint{"torque_loop", 1500, 2, 0.05, kStatic, 500, 0.3},
                      Joint{"series_elastic", 300, 0.5, 0.2, kMotor, 500, 0.3},
                      Joint{"soft_motor", 1500, 2, 0.2, kMotor, 150, 0.7},
                      Joint{"soft_static", 1500, 2, 0.2, kStatic, 150, 0.7},
                      Joint{"stiff_spring_late", 1e5, 20, 0.2, kMotor, 2000, 0.3},
                      Joint{"half_link", 1000, 2, 0.2, kLink, 250, 0.3},
                      Joint{"nearly_its_spring", 1000, 2, 0.2, kStatic, 850, 0.7}),
    [](const auto& tested) { return std::string(tested.param.name); });

// As asked where the spring lets it.
TEST(ElasticDamping, MeetsTheRatioAskedWhereTheSpringAllows) {
  double ratio = 0.0;
  designed({"", 1500, 2, 0.05, kStatic, 500, 0.3}, &ratio);
  EXPECT_NEAR(ratio, 0.3, 1e-9);
  designed({"", 300, 0.5, 0.2, kMotor, 500, 0.3}, &ratio);
  EXPECT_LT(ratio, 0.2);
}

// Just below a share of 1 the motor's swing dies out, just above it does not.
TEST(MotorShare, IsOneWhereTheSampledMotorBeginsToSwing) {
  for (const double B : {0.02, 0.05, 0.2}) {
    const auto share = [&](double K) {
      const ElasticMode mode{.link = 0.5,
                             .rotor = B,
                             .spring = 1500.0,
                             .damper = 0.5,
                             .law = law_stiffness(kMotor, K, 0.0)};
      return motor_share(mode, 0.3 * B / kT, 1.5 * kT);
    };
    double K = 10.0;
    while (share(K) < 1.0) K *= 1.01;
    SampledJoint stable({"", 1500, 0.5, B, kMotor, 0.85 * K, 0.3}, 0.3 * B / kT);
    SampledJoint unstable({"", 1500, 0.5, B, kMotor, 1.15 * K, 0.3}, 0.3 * B / kT);
    EXPECT_LT(stable.overshoot(8.0), 1.0) << B << " " << K;
    EXPECT_GT(unstable.overshoot(8.0), 1.0) << B << " " << K;
  }
}

}  // namespace
}  // namespace limber::controller::test_elastic_damping
