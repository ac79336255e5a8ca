// Stiff joint springs at steps longer than anybody should take.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>

#include "robots/loader/load_robot.h"
#include "sim/plant/arm_plant.h"
#include "sim/plant/start_state.h"
#include "tests/sim/test_arms.h"

namespace limber::sim::test_joint_stability {
namespace {

constexpr double kStep = 250e-6;
/// Energy that is neither lost nor made, to what its samples show of it.
constexpr double kSteady = 1.05;

class JointStability : public ::testing::TestWithParam<Integrator> {};
INSTANTIATE_TEST_SUITE_P(Each, JointStability,
                         ::testing::Values(Integrator::kOde, Integrator::kReference));

/// Most energy in the second half of an arm's motion over the most in its first, after it has been
/// let loose with its springs drawn, free of motor torque and weight. (Not over what it started
/// with: at steps longer than a swing ODE's speeds, half a step late, are those of another phase.)
double growth(LoadedRobot robot, Integrator integrator, double h, double duration_s) {
  for (double& g : robot.robot.gravity) g = 0.0;
  for (JointConfig& joint : robot.robot.joints) {
    joint.position_min = -1e9;
    joint.position_max = 1e9;
  }
  ForceModel forces(robot.robot, false);
  const auto plant = make_arm_plant(integrator, build_arm_model(robot));
  VectorJ q(robot.robot.size());
  for (int i = 0; i < q.size(); ++i) q[i] = robot.robot.joints[i].home;
  start_at(robot.robot, q, true, plant.get());
  ArmState x = plant->state();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int k = 0; k < x.theta.size(); ++k) x.theta[k] += 0.003 * unit(random);
  plant->set_state(x);
  const auto energy = [&] {
    return plant->kinetic_energy() + forces.elastic_energy(plant->state());
  };
  double most[2] = {};
  for (double& half : most) {
    for (int k = 0; k < std::lround(0.5 * duration_s / h); ++k) {
      plant->step(&forces, h, 0);
      half = std::max(half, energy());
    }
  }
  EXPECT_EQ(plant->diverged(), 0);
  return most[1] / most[0];
}

/// A wrist of 0.001 kg m^2 behind a spring of 15000 N m/rad.
LoadedRobot stiff_wrist(double stiffness, double damping) {
  LoadedRobot robot = testing::arm_on_one_bus();
  const KDL::RigidBodyInertia upper(3.0, {0, 0, -0.1}, KDL::RotationalInertia(0.06, 0.06, 0.02));
  const KDL::RigidBodyInertia wrist(0.5, {0, 0, -0.01},
                                    KDL::RotationalInertia(0.001, 0.001, 0.001));
  testing::add_segment(robot, KDL::Joint("a", {}, {1, 0, 0}, KDL::Joint::RotAxis),
                       KDL::Frame(KDL::Vector(0, 0, 0.3)), upper);
  testing::add_segment(robot, KDL::Joint("b", {}, {0, 0, 1}, KDL::Joint::RotAxis),
                       KDL::Frame(KDL::Vector(0, 0, 0.05)), wrist);
  testing::add_segment(robot, KDL::Joint("c", {}, {0, 0, 1}, KDL::Joint::RotAxis),
                       KDL::Frame(KDL::Vector(0, 0, 0.05)), wrist);
  for (int i = 0; i < 3; ++i) {
    robot.robot.joints.push_back(testing::joint_config(i, JointType::kRevolute, 0.2));
    testing::make_elastic(&robot.robot.joints[i], stiffness, damping);
  }
  return robot;
}

TEST_P(JointStability, StiffSpringsOnLightLinksAreStableAtFourTimesTheStep) {
  for (const double damping : {0.0, 6.0, 100.0}) {
    for (const double h : {kStep, 2.0 * kStep, 4.0 * kStep}) {
      const double grown = growth(stiff_wrist(15000.0, damping), GetParam(), h, 0.5);
      EXPECT_LT(grown, damping > 0.0 ? 0.999 : kSteady) << damping << " " << h;
    }
  }
  // As far off as a step sixteen times as long.
  const double grown = growth(stiff_wrist(256.0 * 15000.0, 16.0 * 6.0), GetParam(), kStep, 0.1);
  EXPECT_LT(grown, 0.999);
}

TEST_P(JointStability, EveryShippedRobotIsStableAtFourTimesTheStep) {
  for (const auto& folder : std::filesystem::directory_iterator(robots_root())) {
    if (!std::filesystem::exists(folder.path() / "robot.yaml")) continue;
    const LoadedRobot robot = load_robot(folder.path());
    const auto rigid = [](const JointConfig& joint) { return joint.rigid(); };
    if (std::all_of(robot.robot.joints.begin(), robot.robot.joints.end(), rigid)) continue;
    const double most = growth(robot, GetParam(), 4.0 * kStep, 1.0);
    EXPECT_LT(most, kSteady) << folder.path();
  }
}

}  // namespace
}  // namespace limber::sim::test_joint_stability
