// Where the contact wrench comes from: a sensor, the motors' torque, or nowhere.
#include <gtest/gtest.h>

#include <cmath>

#include "controller/model/singularity.h"
#include "tests/controller/rig.h"

namespace limber::test_contact_sources {
namespace {

using limber::testing::Rig;
using Gains = compliance_gains_t;

struct Touched {
  explicit Touched(std::int8_t contact) : rig(arm()) {
    rig.plant.q << 0.4, -0.8, 0.5, 1.2, -0.6, 0.9, 0.7;
    rig.to_active();
    Gains gains = rig.gains();
    gains.contact = contact;
    EXPECT_EQ(rig.controller.on_gains(gains), nullptr);
    rig.plant.F_ext << 4.0, -3.0, 2.0, 0.2, -0.1, 0.15;
    for (int i = 0; i < 3000; ++i) {
      read_sensor();
      rig.step();
    }
  }
  static LoadedRobot arm() {
    LoadedRobot robot = limber::testing::seven_joint_arm();
    robot.robot.has_tip_sensor = true;
    return robot;
  }
  // A sensor in the tip's axes at its origin, without a tool.
  void read_sensor() {
    const Eigen::Quaterniond Q_TB = rig.plant.model.tip_pose(rig.plant.q).Q.conjugate();
    rig.state.sensor_state = joint_state_t::SENSOR_FRESH;
    Eigen::Vector3d::Map(rig.state.F_sensor) = Q_TB * rig.plant.F_ext.head<3>();
    Eigen::Vector3d::Map(rig.state.F_sensor + 3) = Q_TB * rig.plant.F_ext.tail<3>();
  }
  Vector6 F_ext() const { return Vector6::Map(rig.controller.status().F_ext); }
  VectorJ tau_ext() const {
    return Eigen::Map<const Eigen::VectorXf>(rig.controller.status().tau_ext, 7).cast<double>();
  }
  VectorJ expected_tau() { return rig.plant.model.jacobian(rig.plant.q).transpose() * F(); }
  const Vector6& F() const { return rig.plant.F_ext; }

  Rig rig;
};

TEST(ContactSources, TipSensorSaysThePlantsWrench) {
  Touched arm(Gains::CONTACT_TIP_SENSOR);
  EXPECT_EQ(arm.rig.controller.status().contact, +Gains::CONTACT_TIP_SENSOR);
  EXPECT_LT((arm.F_ext() - arm.F()).norm(), 1e-9);
  EXPECT_LT((arm.tau_ext() - arm.expected_tau()).norm(), 1e-4);
}

TEST(ContactSources, JointTorqueSaysItOnceTheArmRests) {
  Touched arm(Gains::CONTACT_JOINT_TORQUE);
  const auto inverse =
      controller::damped_inverse(arm.rig.plant.model.jacobian(arm.rig.plant.q), 0.05, 0.05);
  ASSERT_EQ(inverse.lambda, 0.0) << "away from singular poses";
  ASSERT_LT(arm.rig.plant.v.norm(), 1e-5);
  EXPECT_EQ(arm.rig.controller.status().contact, +Gains::CONTACT_JOINT_TORQUE);
  EXPECT_LT((arm.tau_ext() - arm.expected_tau()).norm(), 1e-3);
  EXPECT_LT((arm.F_ext() - arm.F()).norm(), 1e-2);
}

// Step of the observed torque: dr/dt = K_O (tau_ext - r).
TEST(ContactSources, JointTorqueRisesWithTheObserversGain) {
  Rig rig(limber::testing::slider());
  rig.to_active();
  Gains gains = rig.gains();
  gains.contact = Gains::CONTACT_JOINT_TORQUE;
  gains.observer_gain_per_s = 20.0F;
  ASSERT_EQ(rig.controller.on_gains(gains), nullptr);
  rig.run(0.5);
  rig.plant.F_ext[0] = 5.0;
  for (int i = 1; i <= 200; ++i) {
    rig.step();
    // The push acts from the first step on; the state of a step is from before it.
    const double r = 5.0 * (1.0 - std::pow(1.0 - 20.0 * 1e-3, i - 1));
    ASSERT_NEAR(rig.controller.status().tau_ext[0], r, 1e-4) << i;
  }
}

TEST(ContactSources, NoneIsZero) {
  Touched arm(Gains::CONTACT_NONE);
  EXPECT_EQ(arm.F_ext().norm(), 0.0);
  EXPECT_EQ(arm.tau_ext().norm(), 0.0);
}

}  // namespace
}  // namespace limber::test_contact_sources
