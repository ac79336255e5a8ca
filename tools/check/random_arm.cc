#include "tools/check/random_arm.h"

#include <kdl/chain.hpp>

#include "controller/kinds/sensors.h"

namespace limber {
namespace {

using namespace controller;

void give_springs(unsigned needs, JointConfig* joint) {
  if ((needs & sensors::kTwoMotors) != 0) {
    joint->transmission.kind = TransmissionKind::kAntagonistic;
    joint->transmission.spring = {.law = SpringLaw::kQuadratic, .k2_Nm_per_rad2 = 400.0};
    joint->transmission.preload_rad = 0.3;
    joint->transmission.preload_max_rad = 0.6;
    joint->has_antagonist = true;
    joint->drive.peak_torque_Nm = 80.0;
    joint->antagonist = joint->drive;
  } else if ((needs & (sensors::kElasticJoints | sensors::kDeflection)) != 0) {
    joint->transmission.kind = TransmissionKind::kElastic;
    joint->transmission.spring.stiffness_Nm_per_rad = 600.0;
  }
}

}  // namespace

double RandomArm::uniform(double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(generator_);
}

int RandomArm::below(int count) {
  return std::uniform_int_distribution<int>(0, count - 1)(generator_);
}

VectorJ RandomArm::joints(int n, double size) {
  VectorJ vector(n);
  for (int i = 0; i < n; ++i) vector[i] = uniform(-size, size);
  return vector;
}

Vector6 RandomArm::six(double size) { return joints(6, size); }

Matrix6 RandomArm::stiffness(double linear, double angular) {
  Vector6 scale;
  scale << Eigen::Vector3d::Constant(std::sqrt(linear)),
      Eigen::Vector3d::Constant(std::sqrt(angular));
  Matrix6 A;
  for (int i = 0; i < 6; ++i) A.col(i) = six(1.0);
  const Matrix6 K = 0.4 * A * A.transpose() + 0.5 * Matrix6::Identity();
  return scale.asDiagonal() * K * scale.asDiagonal();
}

LoadedRobot RandomArm::arm(int joints, unsigned needs) {
  const auto vector = [&](double size) {
    return KDL::Vector(uniform(-size, size), uniform(-size, size), uniform(-size, size));
  };
  LoadedRobot loaded;
  Robot& robot = loaded.robot;
  robot.name = "random";
  for (double& g : robot.gravity) g = uniform(-8.0, 8.0);
  for (int i = 0; i < joints; ++i) {
    const bool slides = joints > 2 && below(6) == 0;
    const KDL::Joint joint("joint" + std::to_string(i), vector(0.05), vector(1.0),
                           slides ? KDL::Joint::TransAxis : KDL::Joint::RotAxis);
    const KDL::Frame frame(KDL::Rotation::RPY(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)),
                           vector(0.2));
    const KDL::RotationalInertia inertia(0.004, 0.005, 0.003, 1e-4, -2e-4, 3e-4);
    loaded.chain.addSegment(KDL::Segment(
        joint, frame, KDL::RigidBodyInertia(uniform(0.1, 0.9), vector(0.05), inertia)));
    JointConfig config;
    config.name = joint.getName();
    config.type = slides ? JointType::kPrismatic : JointType::kRevolute;
    config.position_min = -3.0;
    config.position_max = 3.0;
    config.velocity_limit = 10.0;
    config.torque_limit_Nm = 40.0;
    config.torque_rate_limit_Nm_per_s = 800.0;
    config.drive.rotor_inertia_kgm2 = 0.02;
    config.drive.peak_torque_Nm = 40.0;
    config.link_encoder.present = config.torque_sensor.present = true;
    give_springs(needs, &config);
    robot.joints.push_back(config);
  }
  robot.gains.K_q.assign(static_cast<std::size_t>(joints), 20.0);
  robot.gains.K_null.assign(static_cast<std::size_t>(joints), 0.0);
  robot.gains.D_null.assign(static_cast<std::size_t>(joints), 0.5);
  return loaded;
}

void RandomArm::choose(Gains* gains) {
  const int n = static_cast<int>(gains->K_q.rows());
  const auto diagonal = [&](double size) -> MatrixJ {
    return joints(n, size).cwiseMax(0.0).asDiagonal();
  };
  LawSettings& s = gains->settings;
  s.orientation = static_cast<Orientation>(below(2));  // the others are no gradients
  s.damping = static_cast<DampingDesign>(below(4));
  s.joint_damping = static_cast<DampingDesign>(below(4));
  s.stiffness_terms = static_cast<StiffnessTerms>(below(3));
  s.projector = static_cast<Projector>(below(3));
  gains->K_x = below(8) == 0 ? Matrix6::Zero() : stiffness(800.0, 30.0);
  gains->D_x = stiffness(30.0, 1.0);
  if (below(3) == 0) gains->M_x = stiffness(2.0, 0.1);
  gains->K_q = diagonal(100.0);
  gains->D_q = diagonal(5.0);
  for (const GainRow* row : gains->parameters.rows()) {
    if (row->is_choice()) {
      gains->parameters.set(
          *row,
          row->words[static_cast<std::size_t>(below(static_cast<int>(row->words.size())))].value);
    } else if (row->per_joint) {
      gains->parameters.set(*row, diagonal(std::min(row->high, 100.0)));
    } else {
      gains->parameters.set(*row, uniform(row->low, std::min(row->high, row->low + 100.0)));
    }
  }
}

void RandomArm::move(int n, Goal* goal, Estimates* estimates) {
  goal->V_BD = six(0.5);
  goal->A_BD = six(1.0);
  goal->F_ff = six(10.0);
  goal->v_d = joints(n, 0.5);
  goal->a_d = joints(n, 1.0);
  estimates->tau_ext = joints(n, 3.0);
  estimates->F_ext = six(5.0);
  estimates->A_BT = six(3.0);
}

}  // namespace limber
