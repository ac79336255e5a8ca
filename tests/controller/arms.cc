#include "tests/controller/arms.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <limits>
#include <string>

namespace limber::testing {
namespace {

KDL::Joint joint(KDL::Joint::JointType type) { return KDL::Joint("j", type); }

KDL::RigidBodyInertia inertia(double mass, const KDL::Vector& com, double xx, double yy, double zz,
                              double xy = 0.0, double xz = 0.0, double yz = 0.0) {
  return KDL::RigidBodyInertia(mass, com, KDL::RotationalInertia(xx, yy, zz, xy, xz, yz));
}

}  // namespace

LoadedRobot with_drives(const KDL::Chain& chain, const Eigen::Vector3d& gravity) {
  LoadedRobot loaded;
  loaded.chain = chain;
  Robot& robot = loaded.robot;
  robot.name = "test";
  robot.has_drives = true;
  for (int i = 0; i < 3; ++i) robot.gravity[i] = gravity[i];
  for (unsigned i = 0; i < chain.getNrOfSegments(); ++i) {
    const KDL::Joint::JointType type = chain.getSegment(i).getJoint().getType();
    if (type == KDL::Joint::Fixed) continue;
    JointConfig config;
    config.name = "joint" + std::to_string(robot.joints.size() + 1);
    config.position_min = -3.0;
    config.position_max = 3.0;
    config.velocity_limit = 20.0;
    config.torque_limit_Nm = 60.0;
    config.torque_rate_limit_Nm_per_s = 1000.0;
    config.drive.rotor_inertia_kgm2 = 0.01;
    robot.joints.push_back(config);
  }
  const std::size_t n = robot.joints.size();
  robot.gains.K_q.assign(n, 60.0);
  robot.gains.K_null.assign(n, 5.0);
  robot.gains.D_null.assign(n, 1.0);
  return loaded;
}

LoadedRobot planar_arm(const PlanarParameters& p) {
  KDL::Chain chain;
  KDL::RigidBodyInertia first = inertia(p.m1, KDL::Vector(p.l1 - p.a1, 0, 0), 0, 0, p.I1);
  first = first + inertia(p.motor_mass, KDL::Vector::Zero(), 0, 0, 0);
  chain.addSegment(
      KDL::Segment(joint(KDL::Joint::RotZ), KDL::Frame(KDL::Vector(p.a1, 0, 0)), first));
  chain.addSegment(KDL::Segment(joint(KDL::Joint::RotZ), KDL::Frame(KDL::Vector(p.a2, 0, 0)),
                                inertia(p.m2, KDL::Vector(p.l2 - p.a2, 0, 0), 0, 0, p.I2)));
  LoadedRobot robot = with_drives(chain, Eigen::Vector3d(0, -9.81, 0));
  robot.robot.joints[0].drive.rotor_inertia_kgm2 = p.kr1 * p.kr1 * p.Im1;
  robot.robot.joints[1].drive.rotor_inertia_kgm2 = p.kr2 * p.kr2 * p.Im2;
  return robot;
}

LoadedRobot slider() {
  constexpr double kRotor = 0.01;
  KDL::Chain chain;
  chain.addSegment(KDL::Segment(joint(KDL::Joint::TransX), KDL::Frame::Identity(),
                                inertia(kSliderMass - kRotor, KDL::Vector::Zero(), 1, 1, 1)));
  LoadedRobot robot = with_drives(chain, Eigen::Vector3d::Zero());
  robot.robot.joints[0].drive.rotor_inertia_kgm2 = kRotor;
  return robot;
}

LoadedRobot seven_joint_arm() {
  const KDL::Joint::JointType axes[] = {KDL::Joint::RotZ, KDL::Joint::RotX, KDL::Joint::RotZ,
                                        KDL::Joint::RotY, KDL::Joint::RotZ, KDL::Joint::RotX,
                                        KDL::Joint::RotY};
  const double lengths[] = {0.12, 0.13, 0.15, 0.10, 0.12, 0.02, 0.08};
  KDL::Chain chain;
  double mass = 1.4;
  for (int i = 0; i < 7; ++i) {
    const double l = lengths[i];
    const double r = mass * 0.002;
    chain.addSegment(KDL::Segment(joint(axes[i]),
                                  KDL::Frame(KDL::Vector(i % 2 == 0 ? 0.01 : -0.02, 0.015, l)),
                                  inertia(mass, KDL::Vector(0.01, -0.005, -0.5 * l), r, 1.3 * r,
                                          0.7 * r, 0.1 * r, -0.05 * r, 0.08 * r)));
    mass *= 0.8;
  }
  return with_drives(chain, Eigen::Vector3d(0, 0, -9.81));
}

LoadedRobot elastic_arm(bool sensors) {
  LoadedRobot arm = seven_joint_arm();
  for (std::size_t i = 0; i < arm.robot.joints.size(); ++i) {
    JointConfig& joint = arm.robot.joints[i];
    joint.drive.rotor_inertia_kgm2 = i < 4 ? 0.4 : 0.08;
    joint.transmission.kind = TransmissionKind::kElastic;
    joint.transmission.spring.stiffness_Nm_per_rad = i < 4 ? 843.0 : 250.0;
    joint.transmission.damping_Nms_per_rad = i < 4 ? 0.5 : 0.1;
    joint.link_encoder.present = joint.torque_sensor.present = sensors;
  }
  return arm;
}

LoadedRobot antagonistic_arm() {
  LoadedRobot arm = seven_joint_arm();
  arm.robot.gains.K_x_translation_N_per_m = 250.0;  // half of what the springs allow
  arm.robot.gains.K_x_rotation_Nm_per_rad = 10.0;
  for (JointConfig& joint : arm.robot.joints) {
    joint.drive.rotor_inertia_kgm2 = 0.02;
    joint.drive.peak_torque_Nm = 80.0;
    joint.has_antagonist = true;
    joint.antagonist = joint.drive;
    joint.transmission.kind = TransmissionKind::kAntagonistic;
    joint.transmission.spring.law = SpringLaw::kQuadratic;
    joint.transmission.spring.k2_Nm_per_rad2 = 400.0;
    joint.transmission.damping_Nms_per_rad = 0.1;
    joint.transmission.preload_rad = 0.3;
    joint.transmission.preload_max_rad = 0.6;
    joint.link_encoder.present = joint.torque_sensor.present = true;
  }
  return arm;
}

LoadedRobot random_arm(int joints, unsigned seed, bool prismatic) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto vector = [&](double size) {
    return KDL::Vector(size * uniform(generator), size * uniform(generator),
                       size * uniform(generator));
  };
  const auto frame = [&] {
    return KDL::Frame(
        KDL::Rotation::RPY(uniform(generator), uniform(generator), uniform(generator)),
        vector(0.2));
  };
  KDL::Chain chain;
  chain.addSegment(KDL::Segment(joint(KDL::Joint::Fixed), frame()));
  for (int i = 0; i < joints; ++i) {
    const bool slides = prismatic && i % 3 == 1;
    const KDL::Joint moving("j", vector(0.05), vector(1.0),
                            slides ? KDL::Joint::TransAxis : KDL::Joint::RotAxis);
    const double mass = 0.5 + 0.4 * uniform(generator);
    chain.addSegment(KDL::Segment(
        moving, frame(), inertia(mass, vector(0.05), 0.004, 0.005, 0.003, 1e-4, -2e-4, 3e-4)));
    if (i % 2 == 0) chain.addSegment(KDL::Segment(joint(KDL::Joint::Fixed), frame()));
  }
  return with_drives(chain, Eigen::Vector3d(3.0, -5.0, 7.0));
}

VectorJ random_vector(int n, double size, std::mt19937& generator) {
  std::uniform_real_distribution<double> uniform(-size, size);
  VectorJ vector(n);
  for (int i = 0; i < n; ++i) vector[i] = uniform(generator);
  return vector;
}

Vector6 random_six(double size, std::mt19937& generator) {
  return random_vector(6, size, generator);
}

Matrix6 random_stiffness(double linear, double angular, std::mt19937& generator) {
  Vector6 scale;
  scale << Eigen::Vector3d::Constant(std::sqrt(linear)),
      Eigen::Vector3d::Constant(std::sqrt(angular));
  Matrix6 A;
  for (int i = 0; i < 6; ++i) A.col(i) = random_six(1.0, generator);
  const Matrix6 K = 0.4 * A * A.transpose() + 0.5 * Matrix6::Identity();
  return scale.asDiagonal() * K * scale.asDiagonal();
}

Plant::Plant(const LoadedRobot& robot)
    : q(VectorJ::Zero(robot.robot.size())), v(q), model(robot), terms(robot.robot.size()) {}

VectorJ Plant::acceleration(const VectorJ& q_at, const VectorJ& v_at, const VectorJ& tau) {
  model.evaluate(q_at, v_at, &terms);
  const VectorJ sum = tau - terms.Cv - terms.g + terms.J.transpose() * F_ext;
  return terms.M_total.llt().solve(sum);
}

double Plant::kinetic_energy() {
  model.evaluate(q, v, &terms);
  return terms.kinetic_energy(v);
}

}  // namespace limber::testing
