// The two integrators against each other, against formulas and against mechanics' balances. How far
// they part at a step is what the default step of 0.25 ms was chosen by.
#include <gtest/gtest.h>

#include <cmath>
#include <kdl/chaindynparam.hpp>
#include <numbers>

#include "common/config_error.h"
#include "robots/loader/load_robot.h"
#include "sim/plant/arm_plant.h"
#include "tests/sim/test_arms.h"

namespace limber::sim::test_integrators {
namespace {

using testing::desktop;

constexpr double kStep = 250e-6;

VectorJ home(const LoadedRobot& robot) {
  VectorJ q(robot.robot.size());
  for (int i = 0; i < robot.robot.size(); ++i) q[i] = robot.robot.joints[i].home;
  return q;
}

/// The arm under joint impedance, computed every millisecond from the exact state, around a sine of
/// 0.5 Hz: joint positions of the last of five seconds.
std::vector<VectorJ> track_sine(const LoadedRobot& robot, Integrator integrator, double step) {
  const int n = robot.robot.size();
  ForceModel forces(robot.robot, false);
  const auto plant = make_arm_plant(integrator, build_arm_model(robot));
  plant->set_state(home(robot), VectorJ::Zero(n));
  KDL::ChainDynParam terms(robot.chain, KDL::Vector(robot.robot.gravity[0], robot.robot.gravity[1],
                                                    robot.robot.gravity[2]));
  KDL::JntArray q(static_cast<unsigned>(n));
  KDL::JntArray g(static_cast<unsigned>(n));
  std::vector<VectorJ> out;
  for (int k = 0; k < 5000; ++k) {
    const double phase = std::numbers::pi * k * 1e-3;
    q.data = plant->q();
    terms.JntToGravity(q, g);
    for (int i = 0; i < n; ++i) {
      const DriveConfig& drive = robot.robot.joints[i].drive;
      const double q_des = robot.robot.joints[i].home + 0.1 * (1.0 - std::cos(phase));
      const double v_des = 0.1 * std::numbers::pi * std::sin(phase);
      forces.drives[i].limit = 1e3;
      forces.drives[i].tau_ff = g(static_cast<unsigned>(i)) +
                                drive.hold_kp_Nm_per_rad * (q_des - plant->q()[i]) +
                                drive.hold_kd_Nms_per_rad * (v_des - plant->v()[i]);
    }
    for (int s = 0; s < std::lround(1e-3 / step); ++s) plant->step(&forces, step, 0);
    if (k >= 4000) out.push_back(plant->q());
  }
  return out;
}

double largest_difference(const std::vector<VectorJ>& a, const std::vector<VectorJ>& b) {
  double worst = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    worst = std::max(worst, (a[i] - b[i]).cwiseAbs().maxCoeff());
  }
  return worst;
}

TEST(Integrators, OdeFollowsTheReferenceWhileTracking) {
  const LoadedRobot robot = load_robot("openarm");
  const auto truth = track_sine(robot, Integrator::kReference, kStep);
  const double coarse = largest_difference(track_sine(robot, Integrator::kOde, 1e-3), truth);
  const double fine = largest_difference(track_sine(robot, Integrator::kOde, kStep), truth);
  const double reference =
      largest_difference(track_sine(robot, Integrator::kReference, 1e-3), truth);
  EXPECT_LT(fine, 2e-5);                 // a twentieth of a count of the 14-bit encoder
  EXPECT_NEAR(coarse / fine, 4.0, 0.4);  // first order
  EXPECT_LT(reference, 1e-10);
}

struct Fall {
  double energy_error = 0.0;
  VectorJ q;
};

/// Free fall without stops or friction.
Fall fall(LoadedRobot robot, Integrator integrator, double step, double duration) {
  for (JointConfig& joint : robot.robot.joints) {
    joint.position_min = -1e9;
    joint.position_max = 1e9;
  }
  ForceModel forces(robot.robot, false);
  const auto plant = make_arm_plant(integrator, build_arm_model(robot));
  plant->set_state(home(robot), VectorJ::Zero(robot.robot.size()));
  const double start = plant->arm().potential_energy();
  Fall out;
  for (int k = 0; k < std::lround(duration / step); ++k) {
    plant->step(&forces, step, 0);
    const double energy = plant->arm().kinetic_energy() + plant->arm().potential_energy();
    out.energy_error = std::max(out.energy_error, std::abs(energy - start));
  }
  out.q = plant->q();
  return out;
}

TEST(Integrators, ReferenceConservesEnergyOverFiveSecondsOfFreeFall) {
  EXPECT_LT(fall(load_robot("openarm"), Integrator::kReference, kStep, 5.0).energy_error, 1e-6);
  EXPECT_LT(fall(testing::planar_arm(desktop()), Integrator::kReference, kStep, 5.0).energy_error,
            1e-6);
}

TEST(Integrators, ReferenceIsFourthOrderInFreeFall) {
  const LoadedRobot robot = testing::random_arm(6, true, 3);
  const VectorJ truth = fall(robot, Integrator::kReference, 2.5e-4, 0.5).q;
  const double coarse = (fall(robot, Integrator::kReference, 4e-3, 0.5).q - truth).norm();
  const double fine = (fall(robot, Integrator::kReference, 2e-3, 0.5).q - truth).norm();
  EXPECT_NEAR(std::log2(coarse / fine), 4.0, 0.5);
}

TEST(Integrators, OdeIsFirstOrderInFreeFallWithHingesAndSliders) {
  const LoadedRobot robot = testing::random_arm(6, true, 3);
  const VectorJ truth = fall(robot, Integrator::kReference, 1e-3, 0.5).q;
  const double coarse = (fall(robot, Integrator::kOde, 1e-3, 0.5).q - truth).norm();
  const double fine = (fall(robot, Integrator::kOde, kStep, 0.5).q - truth).norm();
  EXPECT_LT(fine, 5e-3);
  EXPECT_NEAR(coarse / fine, 4.0, 0.4);
}

class BothIntegrators : public ::testing::TestWithParam<Integrator> {
 protected:
  void make(const LoadedRobot& robot, bool friction = false) {
    forces_ = std::make_unique<ForceModel>(robot.robot, friction);
    plant_ = make_arm_plant(GetParam(), build_arm_model(robot));
  }
  void run(double duration_s) {
    for (int k = 0; k < std::lround(duration_s / kStep); ++k) {
      plant_->step(forces_.get(), kStep, static_cast<std::int64_t>(k * kStep * 1e9));
    }
  }
  void set_torque(int joint, double torque) {
    forces_->drives[joint] = {};
    forces_->drives[joint].tau_ff = torque;
    forces_->drives[joint].limit = std::abs(torque);
  }
  double energy() const {
    return plant_->arm().kinetic_energy() + plant_->arm().potential_energy();
  }
  std::unique_ptr<ForceModel> forces_;
  std::unique_ptr<ArmPlant> plant_;
};
INSTANTIATE_TEST_SUITE_P(Each, BothIntegrators,
                         ::testing::Values(Integrator::kOde, Integrator::kReference));

LoadedRobot weightless(LoadedRobot robot) {
  for (double& g : robot.robot.gravity) g = 0.0;
  return robot;
}

TEST_P(BothIntegrators, LinksFeelTheRotors) {
  // Elbow locked by symmetry is not to be had; torques chosen so that only joint 1 accelerates: tau
  // = (M + B) (a, 0).
  const auto s = desktop();
  make(weightless(testing::planar_arm(s)));
  const double a = 2.0;
  const double m12 = s.I2 + s.m2 * (s.l2 * s.l2 + s.a1 * s.l2);
  const double m11 =
      s.I1 + s.m1 * s.l1 * s.l1 + s.motor * s.a1 * s.a1 + s.I2 + s.m2 * std::pow(s.a1 + s.l2, 2);
  set_torque(0, (m11 + s.B1) * a);
  set_torque(1, m12 * a);
  run(kStep);
  EXPECT_NEAR(plant_->v()[0], a * kStep, 1e-9);
  EXPECT_NEAR(plant_->v()[1], 0.0, 1e-9);
}

TEST_P(BothIntegrators, AnglesBeyondAHalfTurnAreCounted) {
  make(weightless(testing::planar_arm(desktop())));
  VectorJ v(2);
  v << -30.0, 0.0;
  plant_->set_state(VectorJ::Zero(2), v);
  run(2.0);
  EXPECT_NEAR(plant_->q()[0], -60.0, 0.1);
  EXPECT_NEAR(plant_->q()[1], 0.0, 0.1);
}

TEST_P(BothIntegrators, WallCarriesStiffnessTimesDepth) {
  LoadedRobot robot = weightless(testing::planar_arm(desktop()));
  for (JointConfig& joint : robot.robot.joints) joint.friction.viscous_Nms_per_rad = 0.5;
  make(robot, true);
  VectorJ q(2);
  q << 0.3, 1.2;
  plant_->set_state(q, VectorJ::Zero(2));
  const Eigen::Vector3d p = plant_->arm().link_position(plant_->arm().tip());
  Wall& wall = forces_->environment.wall;
  wall.normal = Eigen::Vector3d(0, -1, 0);
  wall.point = p + Eigen::Vector3d(0, 0.001, 0);
  wall.stiffness = 2e4;
  wall.damping = 50.0;
  // Joint springs that pull the tip into the wall; a drive holds against it.
  for (int i = 0; i < 2; ++i) {
    forces_->drives[i].kp = 50.0;
    forces_->drives[i].kd = 1.0;
    forces_->drives[i].limit = 7.0;
  }
  forces_->drives[0].q_des = 0.3 + 0.05;
  forces_->drives[1].q_des = 1.2;
  run(4.0);
  const Eigen::Vector3d now = plant_->arm().link_position(plant_->arm().tip());
  const double depth = now.y() - wall.point.y();
  const Vector6 F = forces_->environment.contact_wrench(plant_->arm());
  EXPECT_GT(depth, 1e-5);
  EXPECT_NEAR(F[1], -2e4 * depth, 1e-6);
  EXPECT_EQ(F[0], 0.0);
  // Statics: J^T F balances the motors.
  const VectorJ external = plant_->external_torque(forces_->environment, 0);
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(external[i] + forces_->drives[i].torque(plant_->q()[i], plant_->v()[i]), 0.0, 1e-5);
  }
}

TEST_P(BothIntegrators, NoWallGivesBackMoreThanItTook) {
  for (const double stiffness : {1e3, 1e5, 1e7}) {
    for (const double damping : {0.0, 1e2, 1e5}) {
      make(weightless(testing::planar_arm(desktop())));
      VectorJ q(2);
      VectorJ v(2);
      q << 0.3, 1.2;
      v << 1.0, 0.0;
      plant_->set_state(q, v);
      Wall& wall = forces_->environment.wall;
      wall.normal = Eigen::Vector3d(0, -1, 0);
      wall.point = plant_->arm().link_position(plant_->arm().tip()) + Eigen::Vector3d(0, 0.02, 0);
      wall.stiffness = stiffness;
      wall.damping = damping;
      const double before = energy();
      double least = before;
      for (int k = 0; k < 1000; ++k) {
        run(kStep);
        least = std::min(least, energy());
        ASSERT_LT(energy(), before * 1.05) << stiffness << " " << damping << " " << k;
      }
      EXPECT_LT(least, 0.9 * before);  // it did hit
      const bool elastic = damping == 0.0 && stiffness < 1e6;
      if (elastic && GetParam() == Integrator::kReference) {
        EXPECT_NEAR(energy(), before, 1e-2 * before);
      }
      if (damping > 0.0) {
        EXPECT_LT(energy(), before);
      }
    }
  }
}

TEST_P(BothIntegrators, PayloadWeighsFromTheMomentItIsTaken) {
  const auto s = desktop();
  make(testing::planar_arm(s));
  // Straight along x, held against gravity exactly.
  const double g2 = s.m2 * s.l2 * 9.81;
  set_torque(0, (s.m1 * s.l1 + s.motor * s.a1 + s.m2 * s.a1) * 9.81 + g2);
  set_torque(1, g2);
  run(kStep);
  EXPECT_LT(plant_->v().norm(), 1e-12);
  plant_->set_payload(0.5, Eigen::Vector3d::Zero());
  set_torque(0, forces_->drives[0].tau_ff + 0.5 * 9.81 * (s.a1 + s.a2));
  set_torque(1, forces_->drives[1].tau_ff + 0.5 * 9.81 * s.a2);
  run(kStep);
  EXPECT_LT(plant_->v().norm(), 1e-12);
  plant_->set_payload(0.0, Eigen::Vector3d::Zero());
  run(kStep);
  EXPECT_GT(plant_->v().norm(), 1e-3);
}

TEST(Integrators, PayloadInMotionAgrees) {
  const LoadedRobot robot = load_robot("openarm");
  VectorJ end[2];
  for (const Integrator integrator : {Integrator::kOde, Integrator::kReference}) {
    ForceModel forces(robot.robot, true);
    const auto plant = make_arm_plant(integrator, build_arm_model(robot));
    plant->set_state(home(robot), VectorJ::Constant(7, 0.2));
    for (int k = 0; k < 400; ++k) {
      if (k == 100) plant->set_payload(1.0, Eigen::Vector3d(0.05, 0.0, 0.02));
      if (k == 300) plant->set_payload(0.2, Eigen::Vector3d(0.0, 0.1, 0.0));
      plant->step(&forces, 1e-4, 0);
    }
    end[integrator == Integrator::kOde ? 0 : 1] = plant->q();
  }
  EXPECT_LT((end[0] - end[1]).norm(), 1e-4);
}

TEST_P(BothIntegrators, EndStopHoldsTheArmNearItsLimit) {
  LoadedRobot robot = testing::planar_arm(desktop());
  for (JointConfig& joint : robot.robot.joints) {
    joint.position_min = -1.0;
    joint.position_max = 1.0;
    joint.torque_limit_Nm = 7.0;
    joint.friction.viscous_Nms_per_rad = 0.5;
  }
  make(robot, true);
  double furthest = 0.0;
  for (int k = 0; k < 5000; ++k) {
    run(1e-3);
    furthest = std::max(furthest, plant_->q().cwiseAbs().maxCoeff());
  }
  EXPECT_LT(furthest, 1.0 + 0.06);
  // At rest the stop's spring, 7 N m per 10 mrad, carries gravity.
  EXPECT_LT(plant_->v().norm(), 1e-5);
  EXPECT_NEAR(forces_->stop_torque()[0], 700.0 * (-1.0 - plant_->q()[0]), 1e-4);
  EXPECT_LT(plant_->q()[0], -1.0);
}

TEST_P(BothIntegrators, EnergyIsAccountedFor) {
  const LoadedRobot robot = load_robot("openarm");
  make(robot, true);
  plant_->set_state(home(robot), VectorJ::Zero(7));
  Push push;
  push.link = plant_->arm().tip();
  push.wrench << 10, -5, 3, 0.5, 0, 0.2;
  push.ramp_ns = 100'000'000;
  push.duration_ns = 1'000'000'000;
  ASSERT_TRUE(forces_->environment.pushes.add(push, 0));
  for (int i = 0; i < 7; ++i) {
    forces_->drives[i].kp = robot.robot.joints[i].drive.hold_kp_Nm_per_rad;
    forces_->drives[i].q_des = robot.robot.joints[i].home;
    forces_->drives[i].limit = 20.0;
  }
  const double before = energy();
  run(1.0);
  const Work& work = plant_->work();
  const double balance =
      energy() + forces_->bristle_energy() - before - work.motor - work.external - work.friction;
  EXPECT_GT(std::abs(work.motor), 0.1);
  EXPECT_GT(std::abs(work.external), 0.01);
  EXPECT_LT(work.friction, -0.01);
  // First order in the step for ODE; the reference does its own bookkeeping to fourth order, but
  // for the bristle.
  EXPECT_NEAR(balance, 0.0, GetParam() == Integrator::kOde ? 5e-3 : 1e-4);
}

TEST_P(BothIntegrators, StuckJointsStayWhereTheyAre) {
  LoadedRobot robot = testing::planar_arm(desktop());
  for (JointConfig& joint : robot.robot.joints) {
    joint.friction = {10.0, 12.0, 0.05, 0.1, 1e-4};  // holds the weight
  }
  make(robot, true);
  VectorJ q(2);
  q << 0.2, 0.4;
  plant_->set_state(q, VectorJ::Zero(2));
  run(1.0);
  const VectorJ rested = plant_->q();
  EXPECT_LT((rested - q).cwiseAbs().maxCoeff(), 3e-4);
  run(5.0);
  EXPECT_LT((plant_->q() - rested).cwiseAbs().maxCoeff(), 1e-7);
}

TEST_P(BothIntegrators, FrictionOfAnySizeOnlyTakesEnergy) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> power(-1.0, 1.0);
  for (int trial = 0; trial < 20; ++trial) {
    LoadedRobot robot = weightless(load_robot("openarm"));
    for (JointConfig& joint : robot.robot.joints) {
      joint.friction.coulomb_Nm = std::pow(10.0, power(random) * 1.5);
      joint.friction.static_Nm = joint.friction.coulomb_Nm * (1.5 + power(random) / 2);
      joint.friction.bristle_rad = std::pow(10.0, -5.0 + 3.0 * power(random));
      joint.friction.viscous_Nms_per_rad = std::pow(10.0, power(random) * 2.0);
      joint.position_min = -1e9;
      joint.position_max = 1e9;
    }
    make(robot, true);
    plant_->set_state(home(robot), testing::random_vector(7, 3.0, random));
    const double start = energy();
    double last = start;
    for (int k = 0; k < 400; ++k) {
      run(kStep);
      const double now = energy() + forces_->bristle_energy();
      ASSERT_LT(now, last + 1e-3 * start) << trial << " " << k;
      last = now;
    }
    EXPECT_LT(last, 0.9 * start);
  }
}

TEST_P(BothIntegrators, TorqueThatIsNoNumberStopsTheArmAndIsCounted) {
  make(testing::planar_arm(desktop()));
  run(0.1);
  const VectorJ q = plant_->q();
  set_torque(0, std::numeric_limits<double>::quiet_NaN());
  run(0.01);
  EXPECT_EQ(plant_->diverged(), 40);
  EXPECT_EQ(plant_->q(), q);
  EXPECT_EQ(plant_->v(), VectorJ(VectorJ::Zero(2)));
  set_torque(0, 0.0);
  run(0.1);
  EXPECT_EQ(plant_->diverged(), 40);
  EXPECT_GT((plant_->q() - q).norm(), 1e-3);
}

TEST(Integrators, MasslessLinkIsRefusedByOdeWithAReason) {
  LoadedRobot robot = testing::arm_on_one_bus();
  const KDL::Vector z(0, 0, 1);
  testing::add_segment(robot, KDL::Joint("a", {}, z, KDL::Joint::RotAxis), KDL::Frame::Identity(),
                       KDL::RigidBodyInertia::Zero());
  testing::add_segment(
      robot, KDL::Joint("b", {}, {1, 0, 0}, KDL::Joint::RotAxis),
      KDL::Frame(KDL::Vector(0, 0, 0.3)),
      KDL::RigidBodyInertia(1.0, {0, 0, -0.1}, KDL::RotationalInertia(0.02, 0.02, 0.02)));
  robot.robot.joints = {testing::joint_config(0, JointType::kRevolute, 0.01),
                        testing::joint_config(1, JointType::kRevolute, 0.01)};
  const ArmModel model = build_arm_model(robot);
  try {
    make_arm_plant(Integrator::kOde, model);
    FAIL() << "not refused";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("use integrator: reference"), std::string::npos);
  }
  EXPECT_NO_THROW(make_arm_plant(Integrator::kReference, model));

  robot.robot.joints[0].drive.rotor_inertia_kgm2 = 0.0;
  EXPECT_THROW(make_arm_plant(Integrator::kReference, build_arm_model(robot)), ConfigError);
}

}  // namespace
}  // namespace limber::sim::test_integrators
