// Arms built in code, so that the simulator's tests depend on no file.
#pragma once

#include <kdl/chain.hpp>
#include <random>
#include <string>
#include <utility>

#include "common/types.h"
#include "robots/loader/load_robot.h"
#include "robots/loader/protocols/drive_protocol.h"

namespace limber::testing {

/// One joint with a drive on bus 0, id i + 1, reply id 0x11 + i.
inline JointConfig joint_config(int i, JointType type, double rotor_inertia) {
  JointConfig joint;
  joint.drive.protocol = &protocol_named("damiao_mit");
  joint.name = "joint" + std::to_string(i + 1);
  joint.type = type;
  joint.position_min = -1e9;
  joint.position_max = 1e9;
  joint.velocity_limit = 20.0;
  joint.torque_limit_Nm = 7.0;
  joint.drive.command_id = static_cast<std::uint32_t>(i + 1);
  joint.drive.reply_id = static_cast<std::uint32_t>(i + 0x11);
  joint.drive.range = {12.5, 30.0, 10.0, 500.0, 5.0};
  joint.drive.rotor_inertia_kgm2 = rotor_inertia;
  joint.drive.peak_torque_Nm = 7.0;
  return joint;
}

inline LoadedRobot arm_on_one_bus() {
  LoadedRobot robot;
  robot.robot.name = "test_arm";
  robot.robot.buses.push_back({"arm", "virtual:test", false, 1'000'000, 5'000'000});
  robot.robot.has_drives = true;
  return robot;
}

inline void add_segment(LoadedRobot& robot, const KDL::Joint& joint, const KDL::Frame& tip,
                        const KDL::RigidBodyInertia& inertia) {
  const std::string name = "link" + std::to_string(robot.chain.getNrOfSegments() + 1);
  robot.chain.addSegment(KDL::Segment(name, joint, tip, inertia));
  robot.segment_links.push_back(name);
}

/// Two rods in the x-y plane, gravity along -y, masses m at l with inertia I, lengths a; motor 2 of
/// mass `motor` at the elbow.
struct PlanarSet {
  double a1, a2, l1, l2, m1, m2, I1, I2, motor, B1, B2;
};

inline LoadedRobot planar_arm(const PlanarSet& s) {
  LoadedRobot robot = arm_on_one_bus();
  robot.robot.gravity[1] = -9.81;
  robot.robot.gravity[2] = 0.0;
  const auto rod = [](double m, double l, double a, double I) {
    // Inertias given at the segment's end frame, as KDL wants them.
    return KDL::RigidBodyInertia(m, KDL::Vector(l - a, 0, 0),
                                 KDL::RotationalInertia(0.1 * I, I, I));
  };
  const KDL::RigidBodyInertia elbow_motor(s.motor, KDL::Vector(0, 0, 0));
  const KDL::Vector zero(0, 0, 0);
  const KDL::Vector z(0, 0, 1);
  add_segment(robot, KDL::Joint("joint1", zero, z, KDL::Joint::RotAxis),
              KDL::Frame(KDL::Vector(s.a1, 0, 0)), rod(s.m1, s.l1, s.a1, s.I1) + elbow_motor);
  add_segment(robot, KDL::Joint("joint2", zero, z, KDL::Joint::RotAxis),
              KDL::Frame(KDL::Vector(s.a2, 0, 0)), rod(s.m2, s.l2, s.a2, s.I2));
  add_segment(robot, KDL::Joint(KDL::Joint::Fixed), KDL::Frame::Identity(),
              KDL::RigidBodyInertia::Zero());
  robot.robot.joints = {joint_config(0, JointType::kRevolute, s.B1),
                        joint_config(1, JointType::kRevolute, s.B2)};
  return robot;
}

/// The desk-sized planar arm with 10:1 gears.
inline PlanarSet desktop() {
  return {0.35, 0.3, 0.175, 0.15, 1.2, 0.8, 0.01225, 0.006, 0.3, 1.8e-3, 1.8e-3};
}

/// A random spatial arm: skew axes, off-centre masses, fixed segments between moving ones (one of
/// them before the first joint), every third joint prismatic if `sliders`.
inline LoadedRobot random_arm(int joints, bool sliders, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto vector = [&](double scale) {
    return KDL::Vector(scale * unit(random), scale * unit(random), scale * unit(random));
  };
  const auto frame = [&] {
    return KDL::Frame(KDL::Rotation::RPY(unit(random), unit(random), unit(random)), vector(0.2));
  };
  const auto inertia = [&] {
    const double m = 1.0 + 0.5 * unit(random);
    return KDL::RigidBodyInertia(
        m, vector(0.05),
        KDL::RotationalInertia(0.01 + 0.004 * unit(random), 0.012 + 0.004 * unit(random), 0.011,
                               0.001, -0.002, 0.0015));
  };
  LoadedRobot robot = arm_on_one_bus();
  robot.robot.gravity[0] = 1.0;
  robot.robot.gravity[1] = -2.0;
  robot.robot.gravity[2] = -9.0;
  add_segment(robot, KDL::Joint(KDL::Joint::Fixed), frame(), inertia());
  for (int i = 0; i < joints; ++i) {
    const bool slider = sliders && i % 3 == 1;
    KDL::Vector axis = vector(1.0) + KDL::Vector(0, 0, 0.2);
    axis.Normalize();
    const KDL::Vector origin = vector(0.2);
    add_segment(robot,
                KDL::Joint("joint" + std::to_string(i + 1), origin, axis,
                           slider ? KDL::Joint::TransAxis : KDL::Joint::RotAxis),
                frame(), inertia());
    if (i % 2 == 0) add_segment(robot, KDL::Joint(KDL::Joint::Fixed), frame(), inertia());
    robot.robot.joints.push_back(
        joint_config(i, slider ? JointType::kPrismatic : JointType::kRevolute, 0.01 + 0.005 * i));
  }
  return robot;
}

/// One link about +z, 4 kg at 0.25 m along x and `inertia` about the axis, gravity along -y.
inline LoadedRobot one_joint(double inertia, double rotor_inertia, double gravity) {
  LoadedRobot robot = arm_on_one_bus();
  robot.robot.gravity[1] = -gravity;
  robot.robot.gravity[2] = 0.0;
  // Given at the segment's end, which is on the axis.
  add_segment(robot, KDL::Joint("joint1", {}, {0, 0, 1}, KDL::Joint::RotAxis),
              KDL::Frame::Identity(),
              KDL::RigidBodyInertia(4.0, {0.25, 0, 0},
                                    KDL::RotationalInertia(0.1, inertia - 0.25, inertia - 0.25)));
  robot.robot.joints = {joint_config(0, JointType::kRevolute, rotor_inertia)};
  return robot;
}

inline void make_elastic(JointConfig* joint, double stiffness, double damping) {
  joint->transmission.kind = TransmissionKind::kElastic;
  joint->transmission.spring.stiffness_Nm_per_rad = stiffness;
  joint->transmission.damping_Nms_per_rad = damping;
}

/// A second motor of the same kind, id 0x21 + i, quadratic springs.
inline void make_antagonistic(JointConfig* joint, double k2, double preload) {
  joint->transmission.kind = TransmissionKind::kAntagonistic;
  joint->transmission.spring.law = SpringLaw::kQuadratic;
  joint->transmission.spring.k2_Nm_per_rad2 = k2;
  joint->transmission.preload_rad = preload;
  joint->has_antagonist = true;
  joint->antagonist = joint->drive;
  joint->antagonist.command_id += 0x20;
  joint->antagonist.reply_id += 0x20;
}

inline VectorJ random_vector(int size, double scale, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-scale, scale);
  VectorJ out(size);
  for (int i = 0; i < size; ++i) out[i] = unit(random);
  return out;
}

}  // namespace limber::testing
