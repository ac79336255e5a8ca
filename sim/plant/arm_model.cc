#include "sim/plant/arm_model.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include "common/config_error.h"
#include "common/joints.h"

namespace limber::sim {
namespace {

Eigen::Vector3d to_eigen(const KDL::Vector& v) { return {v.x(), v.y(), v.z()}; }

Eigen::Matrix3d to_eigen(const KDL::Rotation& rotation) {
  Eigen::Matrix3d out;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) out(row, column) = rotation(row, column);
  }
  return out;
}

bool is_prismatic(KDL::Joint::JointType type) {
  return type == KDL::Joint::TransAxis || type == KDL::Joint::TransX ||
         type == KDL::Joint::TransY || type == KDL::Joint::TransZ;
}

/// KDL keeps the rotational inertia about the frame's origin; dynamics here wants it about the
/// centre of mass.
MassProperties to_mass_properties(KDL::RigidBodyInertia inertia) {
  MassProperties out;
  out.mass = inertia.getMass();
  if (out.mass > 0.0) out.com = to_eigen(inertia.getCOG());
  const KDL::RotationalInertia about_com =
      inertia.RefPoint(KDL::Vector(out.com.x(), out.com.y(), out.com.z())).getRotationalInertia();
  out.inertia = Eigen::Map<const Eigen::Matrix3d>(about_com.data);
  return out;
}

void add_motors(const JointConfig& joint, int i, ArmModel* model) {
  if (joint.rigid()) {
    model->bodies[i].rotor_inertia = joint.drive.rotor_inertia_kgm2;
    model->motors.push_back({i, 1.0, true, 0.0});
    return;
  }
  model->motors.push_back({i, 1.0, false, joint.drive.rotor_inertia_kgm2});
  if (joint.has_antagonist) {
    model->motors.push_back({i, -1.0, false, joint.antagonist.rotor_inertia_kgm2});
  }
}

}  // namespace

MassProperties with_point_mass(const MassProperties& body, double mass,
                               const Eigen::Vector3d& position) noexcept {
  MassProperties out;
  out.mass = body.mass + mass;
  if (!(out.mass > 0.0)) return body;
  out.com = (body.mass * body.com + mass * position) / out.mass;
  out.inertia = body.inertia;
  const auto add = [&out](double m, const Eigen::Vector3d& from) {
    const Eigen::Vector3d d = from - out.com;
    out.inertia += m * (d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose());
  };
  add(body.mass, body.com);
  add(mass, position);
  return out;
}

double own_inertia(const BodyModel& body) noexcept {
  if (body.prismatic) return body.mass.mass;
  return body.axis.dot(body.mass.inertia * body.axis) +
         body.mass.mass * body.mass.com.cross(body.axis).squaredNorm();
}

ArmModel build_arm_model(const LoadedRobot& robot) {
  ArmModel model;
  model.gravity = Eigen::Map<const Eigen::Vector3d>(robot.robot.gravity);

  // Pose of the end of the segments walked so far in the present body's frame, and what this body
  // weighs.
  KDL::Frame in_body = KDL::Frame::Identity();
  KDL::RigidBodyInertia inertia = KDL::RigidBodyInertia::Zero();
  const auto close_body = [&] {
    if (!model.bodies.empty()) model.bodies.back().mass = to_mass_properties(inertia);
    inertia = KDL::RigidBodyInertia::Zero();
  };
  for (unsigned i = 0; i < robot.chain.getNrOfSegments(); ++i) {
    const KDL::Segment& segment = robot.chain.getSegment(i);
    const KDL::Joint& joint = segment.getJoint();
    if (joint.getType() != KDL::Joint::Fixed) {
      close_body();
      BodyModel body;
      const KDL::Frame at_zero = in_body * joint.pose(0.0);
      body.prismatic = is_prismatic(joint.getType());
      body.axis = to_eigen(joint.pose(0.0).M.Inverse() * joint.JointAxis()).normalized();
      body.R_PJ = to_eigen(at_zero.M);
      body.p_PJ = to_eigen(at_zero.p);
      model.bodies.push_back(body);
      in_body = joint.pose(0.0).Inverse() * segment.getFrameToTip();
    } else {
      in_body = in_body * segment.getFrameToTip();
    }
    inertia = inertia + in_body * segment.getInertia();
    const bool named = i < robot.segment_links.size();
    model.links.push_back({named ? robot.segment_links[i] : segment.getName(), model.size() - 1,
                           to_eigen(in_body.M), to_eigen(in_body.p)});
  }
  close_body();

  if (model.size() < 1 || model.size() > kMaxJoints || model.size() != robot.robot.size()) {
    throw ConfigError(fmt::format(
        "{}: the chain has {} moving joints and the robot {}; 1 to {}, and as many, are allowed",
        robot.robot.name, model.size(), robot.robot.size(), kMaxJoints));
  }
  for (int i = 0; i < model.size(); ++i) add_motors(robot.robot.joints[i], i, &model);
  return model;
}

}  // namespace limber::sim
