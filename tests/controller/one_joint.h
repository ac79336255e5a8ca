// One joint with a spring about a horizontal axis, and a rod that hangs at q = 0.
#pragma once

#include "tests/controller/arms.h"

namespace limber::testing {

struct OneJoint {
  double K_J = 1000.0;   ///< N m/rad
  double D_J = 2.0;      ///< N m s/rad
  double weight = 9.81;  ///< greatest torque of the rod's weight, N m
  double M = 0.5;        ///< link inertia, kg m^2
  double B = 0.2;        ///< rotor inertia behind the gear, kg m^2
  double K_q = 500.0;    ///< default joint stiffness, N m/rad
  bool sensors = true;   ///< link encoder and torque sensor
};

/// The tip is 0.5 m from the axis.
inline LoadedRobot one_joint(const OneJoint& p) {
  constexpr double kLength = 0.5;
  const double mass = p.M / (kLength * kLength);
  KDL::Chain chain;
  chain.addSegment(KDL::Segment(
      KDL::Joint("j", KDL::Joint::RotZ), KDL::Frame(KDL::Vector(0, -kLength, 0)),
      KDL::RigidBodyInertia(mass, KDL::Vector::Zero(), KDL::RotationalInertia::Zero())));
  LoadedRobot robot = with_drives(chain, Eigen::Vector3d(0, -p.weight / (mass * kLength), 0));
  JointConfig& joint = robot.robot.joints[0];
  joint.drive.rotor_inertia_kgm2 = p.B;
  joint.transmission.kind = TransmissionKind::kElastic;
  joint.transmission.spring.stiffness_Nm_per_rad = p.K_J;
  joint.transmission.damping_Nms_per_rad = p.D_J;
  joint.link_encoder.present = joint.torque_sensor.present = p.sensors;
  robot.robot.gains.K_q = {p.K_q};
  return robot;
}

/// Two motors with quadratic springs instead, k2 = 400 N m/rad^2, preload 0.3 rad at rest.
inline LoadedRobot one_pair(const OneJoint& p) {
  LoadedRobot robot = one_joint(p);
  JointConfig& joint = robot.robot.joints[0];
  joint.drive.rotor_inertia_kgm2 = 0.5 * p.B;
  joint.drive.peak_torque_Nm = 80.0;
  joint.has_antagonist = true;
  joint.antagonist = joint.drive;
  joint.transmission.kind = TransmissionKind::kAntagonistic;
  joint.transmission.spring = {.law = SpringLaw::kQuadratic, .k2_Nm_per_rad2 = 400.0};
  joint.transmission.preload_rad = 0.3;
  joint.transmission.preload_max_rad = 0.6;
  return robot;
}

}  // namespace limber::testing
