// Motors and valves against their closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sim/joints/actuator.h"

namespace limber::sim::test_actuator {
namespace {

constexpr double kStep = 250e-6;

/// 2 N m/A and 2 V s/rad at the joint, 0.5 ohm, 1 mH.
DriveConfig motor(ActuatorKind kind) {
  DriveConfig drive;
  drive.torque_constant_Nm_per_A = 2.0;
  drive.actuator.kind = kind;
  drive.actuator.resistance_ohm = 0.5;
  drive.actuator.inductance_H = 1e-3;
  drive.actuator.back_emf_Vs_per_rad = 2.0;
  return drive;
}

/// Torque of the last of the steps that fill the time.
double run(Actuator* actuator, double command, double theta_dot, double time, double h = kStep) {
  const long steps = std::lround(time / h);
  for (long k = 0; k < steps; ++k) actuator->step(command, 0.0, theta_dot, h);
  return actuator->torque();
}

TEST(Actuator, IdealGivesExactlyTheCommand) {
  Actuator bare;
  Actuator told(DriveConfig(), DriveConfig().torque_constant_Nm_per_A);
  EXPECT_TRUE(bare.ideal());
  EXPECT_TRUE(told.ideal());
  for (const double command : {-0.1, 0.3, 1e3}) {
    EXPECT_EQ(bare.step(command, 1.0, 5.0, kStep), command);
    EXPECT_EQ(told.step(command, 1.0, 5.0, kStep), command);
    EXPECT_EQ(told.torque(), command);
  }
}

TEST(Actuator, WrongTorqueConstantScalesTheTorque) {
  for (const ActuatorKind kind : {ActuatorKind::kIdeal, ActuatorKind::kCurrentDrive}) {
    Actuator actuator(motor(kind), 2.5);
    EXPECT_FALSE(actuator.ideal());
    EXPECT_NEAR(run(&actuator, 10.0, 1.0, 0.1), 0.8 * 10.0, 1e-12);
    EXPECT_NEAR(actuator.current_A(), 4.0, 1e-12);
  }
}

TEST(Actuator, CurrentLoopIsALagWhateverTheStep) {
  constexpr double kLag = 3e-3;
  DriveConfig drive = motor(ActuatorKind::kCurrentDrive);
  drive.actuator.lag_s = kLag;
  for (const double h : {1e-3, 250e-6, 62.5e-6}) {
    Actuator actuator(drive, 2.0);
    double impulse = 0.0;
    for (int k = 1; k * h < 6e-3 + 0.5 * h; ++k) {
      impulse += h * actuator.step(10.0, 0.0, 7.0, h);
      const double t = k * h;
      EXPECT_NEAR(actuator.current_A(), 5.0 * (1.0 - std::exp(-t / kLag)), 1e-12);
      EXPECT_NEAR(impulse, 10.0 * (t - kLag * (1.0 - std::exp(-t / kLag))), 1e-12);
    }
  }
}

TEST(Actuator, CurrentIsLimited) {
  DriveConfig drive = motor(ActuatorKind::kCurrentDrive);
  drive.actuator.current_limit_A = 3.0;
  Actuator actuator(drive, 2.0);
  EXPECT_NEAR(run(&actuator, 100.0, 0.0, 0.01), 6.0, 1e-12);
  EXPECT_NEAR(run(&actuator, -100.0, 0.0, 0.01), -6.0, 1e-12);
}

// At most k_t (U - k_e w) / R, nothing at w = U / k_e, and a brake beyond; the other way the
// voltage helps.
TEST(Actuator, SupplyVoltageLimitsTorqueOverSpeed) {
  DriveConfig drive = motor(ActuatorKind::kCurrentDrive);
  drive.actuator.supply_V = 24.0;
  for (const double speed : {0.0, 5.0, 10.0, 12.0, 14.0}) {
    Actuator actuator(drive, 2.0);
    EXPECT_NEAR(run(&actuator, 1e3, speed, 0.1), 2.0 * (24.0 - 2.0 * speed) / 0.5, 1e-9) << speed;
    actuator.reset();
    EXPECT_NEAR(run(&actuator, -1e3, speed, 0.1), -2.0 * (24.0 + 2.0 * speed) / 0.5, 1e-9);
  }
  Actuator easy(drive, 2.0);
  EXPECT_NEAR(run(&easy, 10.0, 10.0, 0.1), 10.0, 1e-12);  // needs 22.5 of 24 V
}

// A loop of no lag asks for all the voltage there is: L i' + R i = U.
TEST(Actuator, SupplyVoltageLimitsTheRiseOfCurrent) {
  DriveConfig drive = motor(ActuatorKind::kCurrentDrive);
  drive.actuator.supply_V = 24.0;
  Actuator actuator(drive, 2.0);
  for (int k = 1; k <= 8; ++k) {
    actuator.step(60.0, 0.0, 0.0, 100e-6);
    const double rising = 24.0 / 0.5 * (1.0 - std::exp(-k * 100e-6 * 0.5 / 1e-3));
    EXPECT_NEAR(actuator.current_A(), std::min(rising, 30.0), 1e-12) << k;
    if (k > 1) continue;
    const double mean_A = 24.0 / 0.5 * (1.0 - (1.0 - std::exp(-0.05)) / 0.05);
    EXPECT_NEAR(actuator.torque(), 2.0 * mean_A, 1e-12);
  }
}

TEST(Actuator, VoltageDriveAddsDamping) {
  Actuator actuator(motor(ActuatorKind::kVoltageDrive), 2.0);
  for (const double speed : {-3.0, 0.0, 0.5, 10.0})
    EXPECT_NEAR(run(&actuator, 7.0, speed, 0.1), 7.0 - 2.0 * 2.0 / 0.5 * speed, 1e-9) << speed;
}

TEST(Actuator, VoltageDriveFollowsItsElectricalTimeConstant) {
  Actuator actuator(motor(ActuatorKind::kVoltageDrive), 2.5);
  for (int k = 1; k <= 20; ++k) {
    actuator.step(5.0, 0.0, 0.0, kStep);
    EXPECT_NEAR(actuator.current_A(), 2.0 * (1.0 - std::exp(-k * kStep * 0.5 / 1e-3)), 1e-12);
  }
  EXPECT_NEAR(run(&actuator, 5.0, 0.0, 0.1), 0.8 * 5.0, 1e-9);
}

TEST(Actuator, VoltageDriveEndsAtItsSupply) {
  DriveConfig drive = motor(ActuatorKind::kVoltageDrive);
  drive.actuator.supply_V = 12.0;
  Actuator actuator(drive, 2.0);
  EXPECT_NEAR(run(&actuator, 1e3, 4.0, 0.1), 2.0 * (12.0 - 2.0 * 4.0) / 0.5, 1e-9);
}

TEST(Actuator, WindingWarmsUpWithItsTimeConstant) {
  DriveConfig drive = motor(ActuatorKind::kCurrentDrive);
  drive.actuator.thermal_resistance_K_per_W = 4.0;
  drive.actuator.thermal_capacity_J_per_K = 10.0;
  Actuator actuator(drive, 2.0);
  const double steady = 4.0 * 0.5 * 5.0 * 5.0;
  for (const double t : {20.0, 40.0, 80.0}) {
    actuator.reset();
    run(&actuator, 10.0, 0.0, t, 1e-2);
    EXPECT_NEAR(actuator.winding_degC(), 25.0 + steady * (1.0 - std::exp(-t / 40.0)), 1e-9);
  }
}

// Hotter copper makes more heat: x = R_th R (1 + a x) i^2 above 25 degC.
TEST(Actuator, SteadyTemperatureCountsTheCoppersOwnRise) {
  DriveConfig drive = motor(ActuatorKind::kCurrentDrive);
  drive.actuator.thermal_resistance_K_per_W = 4.0;
  drive.actuator.thermal_capacity_J_per_K = 1.0;
  drive.actuator.copper_per_K = 0.0039;
  drive.actuator.magnet_per_K = -0.0015;
  Actuator actuator(drive, 2.0);
  const double torque = run(&actuator, 10.0, 0.0, 200.0, 1e-2);
  const double cold = 4.0 * 0.5 * 25.0;
  const double steady = cold / (1.0 - 0.0039 * cold);
  EXPECT_NEAR(actuator.winding_degC(), 25.0 + steady, 1e-6);
  EXPECT_NEAR(torque, 10.0 * (1.0 - 0.0015 * steady), 1e-6);
  EXPECT_NEAR(actuator.current_A(), 5.0, 1e-12);
}

TEST(Actuator, WarmCopperTakesTorqueFromAVoltageDrive) {
  DriveConfig drive = motor(ActuatorKind::kVoltageDrive);
  drive.actuator.thermal_resistance_K_per_W = 4.0;
  drive.actuator.thermal_capacity_J_per_K = 1.0;
  drive.actuator.copper_per_K = 0.0039;
  Actuator actuator(drive, 2.0);
  const double torque = run(&actuator, 10.0, 0.0, 200.0, 1e-2);
  const double warmth = actuator.winding_degC() - 25.0;
  const double R = 0.5 * (1.0 + 0.0039 * warmth);
  EXPECT_NEAR(torque, 10.0 * 0.5 / R, 1e-6);
  EXPECT_NEAR(warmth, 4.0 * R * std::pow(2.5 / R, 2), 1e-6);
}

TEST(Actuator, CoggingIsASineOfTheAngle) {
  DriveConfig drive = motor(ActuatorKind::kCurrentDrive);
  drive.actuator.cogging_Nm = 0.3;
  drive.actuator.cogging_periods = 84;
  Actuator actuator(drive, 2.0);
  for (const double theta : {-1.0, 0.0, 0.01, 2.0})
    EXPECT_NEAR(actuator.step(4.0, theta, 0.0, kStep), 4.0 + 0.3 * std::sin(84 * theta), 1e-12);
}

/// K_h c_l = 200 / s, D_h / c_l = 30 N m s/rad.
DriveConfig valve() {
  DriveConfig drive;
  drive.actuator.kind = ActuatorKind::kHydraulic;
  drive.actuator.leakage_m3_per_s_per_Nm = 1e-7;
  drive.actuator.fluid_stiffness_Nm_per_m3 = 2e9;
  drive.actuator.displacement_m3_per_rad = 3e-6;
  return drive;
}

TEST(Actuator, HydraulicIsALag) {
  for (const double h : {1e-3, 62.5e-6}) {
    Actuator actuator(valve(), 1.0);
    double impulse = 0.0;
    const long steps = std::lround(8e-3 / h);
    for (long k = 0; k < steps; ++k) impulse += h * actuator.step(50.0, 0.0, 0.0, h);
    EXPECT_NEAR(impulse, 50.0 * (8e-3 - 5e-3 * (1.0 - std::exp(-8e-3 / 5e-3))), 1e-11);
    EXPECT_NEAR(run(&actuator, 50.0, 0.0, 0.2, h), 50.0, 1e-9);
  }
}

TEST(Actuator, HydraulicDampsByDisplacementOverLeakage) {
  Actuator actuator(valve(), 1.0);
  for (const double speed : {-1.0, 0.2, 2.0})
    EXPECT_NEAR(run(&actuator, 50.0, speed, 0.2), 50.0 - 30.0 * speed, 1e-9);
}

TEST(Actuator, WhatIsNoNumberIsNoCommand) {
  DriveConfig drive = motor(ActuatorKind::kCurrentDrive);
  drive.actuator.lag_s = 1e-3;
  drive.actuator.supply_V = 24.0;
  const double bad[] = {std::nan(""), std::numeric_limits<double>::infinity()};
  for (const DriveConfig& config : {drive, motor(ActuatorKind::kVoltageDrive), valve()}) {
    Actuator actuator(config, 2.0);
    for (const double command : bad) EXPECT_EQ(actuator.step(command, 0.0, 0.0, kStep), 0.0);
    EXPECT_TRUE(std::isfinite(actuator.step(1.0, 0.0, 0.0, kStep)));
  }
}

TEST(Actuator, ResetForgetsCurrentPressureAndHeat) {
  DriveConfig drive = motor(ActuatorKind::kVoltageDrive);
  drive.actuator.thermal_resistance_K_per_W = 4.0;
  for (const DriveConfig& config : {drive, valve()}) {
    Actuator actuator(config, 2.0);
    const double first = actuator.step(10.0, 0.0, 0.0, kStep);
    run(&actuator, 10.0, 0.0, 1.0);
    actuator.reset();
    EXPECT_EQ(actuator.torque(), 0.0);
    EXPECT_EQ(actuator.current_A(), 0.0);
    EXPECT_EQ(actuator.winding_degC(), 25.0);
    EXPECT_EQ(actuator.step(10.0, 0.0, 0.0, kStep), first);
  }
}

}  // namespace
}  // namespace limber::sim::test_actuator
