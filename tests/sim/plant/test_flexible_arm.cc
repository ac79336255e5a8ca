// A seven-joint arm with joint springs against an integration of its own: KDL's M, C v and g,
// factorised, with the motors beside, by Runge-Kutta 4 at a step at which nothing changes any more.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <kdl/chaindynparam.hpp>
#include <numbers>
#include <vector>

#include "sim/plant/arm_plant.h"
#include "sim/plant/start_state.h"
#include "tests/sim/test_arms.h"

namespace limber::sim::test_flexible_arm {
namespace {

constexpr int kSize = 7;
constexpr double kDuration_s = 2.0;
constexpr std::array<double, kSize> kRotor = {1.0, 1.0, 0.8, 0.8, 0.4, 0.3, 0.3};
constexpr std::array<double, kSize> kSpring = {8e3, 8e3, 6e3, 6e3, 3e3, 3e3, 2e3};
constexpr std::array<double, kSize> kDamper = {8.0, 8.0, 6.0, 6.0, 2.0, 2.0, 2.0};

LoadedRobot flexible_arm() {
  LoadedRobot robot = testing::random_arm(kSize, false, 11);
  for (int i = 0; i < kSize; ++i) {
    JointConfig& joint = robot.robot.joints[i];
    joint.drive.rotor_inertia_kgm2 = kRotor[i];
    testing::make_elastic(&joint, kSpring[i], kDamper[i]);
  }
  return robot;
}

/// Servo on the motor, its target renewed every millisecond.
DriveLaw law(int joint, int millisecond) {
  const double phase = std::numbers::pi * 1e-3 * millisecond + 0.3 * joint;
  DriveLaw out;
  out.kp = 600.0 * kRotor[joint];
  out.kd = 30.0 * kRotor[joint];
  out.q_des = 0.3 * (std::cos(0.3 * joint) - std::cos(phase));
  out.v_des = 0.3 * std::numbers::pi * std::sin(phase);
  out.limit = 1e4;
  return out;
}

/// Position of the links every millisecond.
using Path = std::vector<VectorJ>;

Path simulate(Integrator integrator, double step) {
  const LoadedRobot robot = flexible_arm();
  ForceModel forces(robot.robot, false);
  const auto plant = make_arm_plant(integrator, build_arm_model(robot));
  start_at(robot.robot, VectorJ::Zero(kSize), false, plant.get());
  Path path;
  for (int k = 0; k < std::lround(1e3 * kDuration_s); ++k) {
    for (int i = 0; i < kSize; ++i) forces.drives[i] = law(i, k);
    for (int s = 0; s < std::lround(1e-3 / step); ++s) plant->step(&forces, step, 0);
    path.push_back(plant->q());
  }
  return path;
}

class KdlArm {
 public:
  /// q, v, theta, theta_dot
  using State = Eigen::Matrix<double, 4 * kSize, 1>;

  KdlArm() : robot_(flexible_arm()), terms_(robot_.chain, gravity(robot_)) {}

  Path simulate(double step) {
    State x = State::Zero();
    KDL::JntArray q(kSize), g(kSize);
    terms_.JntToGravity(q, g);
    for (int i = 0; i < kSize; ++i) x[2 * kSize + i] = g(i) / kSpring[i];
    Path path;
    for (int k = 0; k < std::lround(1e3 * kDuration_s); ++k) {
      for (int s = 0; s < std::lround(1e-3 / step); ++s) {
        const State k1 = rate(x, k);
        const State k2 = rate(x + 0.5 * step * k1, k);
        const State k3 = rate(x + 0.5 * step * k2, k);
        const State k4 = rate(x + step * k3, k);
        x += step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
      }
      path.emplace_back(x.head<kSize>());
    }
    return path;
  }

 private:
  static KDL::Vector gravity(const LoadedRobot& robot) {
    return {robot.robot.gravity[0], robot.robot.gravity[1], robot.robot.gravity[2]};
  }

  State rate(const State& x, int millisecond) {
    KDL::JntArray q(kSize), v(kSize), c(kSize), g(kSize);
    KDL::JntSpaceInertiaMatrix M(kSize);
    q.data = x.head<kSize>();
    v.data = x.segment<kSize>(kSize);
    terms_.JntToMass(q, M);
    terms_.JntToCoriolis(q, v, c);
    terms_.JntToGravity(q, g);
    State out;
    Eigen::Matrix<double, kSize, 1> net = -c.data - g.data;
    for (int i = 0; i < kSize; ++i) {
      const double theta = x[2 * kSize + i];
      const double speed = x[3 * kSize + i];
      const double passed = kSpring[i] * (theta - q(i)) + kDamper[i] * (speed - v(i));
      const DriveLaw servo = law(i, millisecond);
      const double motor = servo.kp * (servo.q_des - theta) + servo.kd * (servo.v_des - speed);
      net[i] += passed;
      out[3 * kSize + i] = (motor - passed) / kRotor[i];
    }
    out.segment<kSize>(2 * kSize) = x.tail<kSize>();
    out.head<kSize>() = v.data;
    out.segment<kSize>(kSize) = M.data.ldlt().solve(net);
    return out;
  }

  LoadedRobot robot_;
  KDL::ChainDynParam terms_;
};

double largest_difference(const Path& a, const Path& b) {
  double worst = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    worst = std::max(worst, (a[i] - b[i]).cwiseAbs().maxCoeff());
  }
  return worst;
}

double travel(const Path& path) { return largest_difference(path, Path(path.size(), path[0])); }

TEST(FlexibleArm, BothIntegratorsFollowAnIndependentIntegration) {
  const Path truth = KdlArm().simulate(100e-6);
  ASSERT_GT(travel(truth), 0.5);
  EXPECT_LT(largest_difference(simulate(Integrator::kReference, 250e-6), truth), 1e-8);
  const double coarse = largest_difference(simulate(Integrator::kOde, 500e-6), truth);
  const double fine = largest_difference(simulate(Integrator::kOde, 250e-6), truth);
  EXPECT_LT(fine, 3e-4);                 // a quarter of a step's motion, at speeds of 1 rad/s
  EXPECT_NEAR(coarse / fine, 2.0, 0.1);  // first order
}

}  // namespace
}  // namespace limber::sim::test_flexible_arm
