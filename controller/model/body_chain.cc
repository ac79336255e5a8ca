#include "controller/model/body_chain.h"

#include <Eigen/Geometry>

#include "common/config_error.h"

namespace limber::controller {
namespace {

constexpr double kUnitRounding = 1e-9;

Eigen::Vector3d to_eigen(const KDL::Vector& v) { return {v.x(), v.y(), v.z()}; }

bool slides(const KDL::Joint& joint) { return joint.twist(1.0).rot.Norm() == 0.0; }

Eigen::Matrix3d to_eigen(const KDL::Rotation& R) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.data);
}

/// Axes with z along `axis`, a unit vector.
KDL::Rotation with_z(const KDL::Vector& axis) {
  const Eigen::Vector3d x = to_eigen(axis).unitOrthogonal();
  const KDL::Vector X(x[0], x[1], x[2]);
  return {X, axis * X, axis};
}

void check(const KDL::Joint& joint) {
  const KDL::Twist rate = joint.twist(1.0);
  const KDL::Vector& moving = slides(joint) ? rate.vel : rate.rot;
  if (KDL::Equal(moving, joint.JointAxis(), kUnitRounding) && joint.getInertia() == 0.0) return;
  throw ConfigError("joint '" + joint.getName() +
                    "' of the chain has a scale or an inertia of its own; neither is allowed");
}

void set_mass(const KDL::RigidBodyInertia& sum, Body* body) {
  body->mass = sum.getMass();
  if (!(body->mass > 0.0)) return;
  body->com = to_eigen(sum.getCOG());
  const Eigen::Vector3d& c = body->com;
  const Eigen::Matrix3d about_origin =
      Eigen::Map<const Eigen::Matrix3d>(sum.getRotationalInertia().data);
  body->inertia = about_origin -
                  body->mass * (c.squaredNorm() * Eigen::Matrix3d::Identity() - c * c.transpose());
}

}  // namespace

BodyChain body_chain(const KDL::Chain& chain) {
  BodyChain result;
  KDL::Frame X = KDL::Frame::Identity();  // end of the segments so far in the last body's frame
  KDL::RigidBodyInertia sum = KDL::RigidBodyInertia::Zero();
  for (const KDL::Segment& segment : chain.segments) {
    const KDL::Joint& joint = segment.getJoint();
    if (joint.getType() != KDL::Joint::Fixed) {
      check(joint);
      if (!result.bodies.empty()) set_mass(sum, &result.bodies.back());
      sum = KDL::RigidBodyInertia::Zero();
      const KDL::Frame X_joint(with_z(joint.JointAxis()), joint.JointOrigin());
      const KDL::Frame X_body = X * X_joint;
      result.bodies.push_back(
          {.prismatic = slides(joint), .R = to_eigen(X_body.M), .p = to_eigen(X_body.p)});
      X = X_joint.Inverse();
    }
    X = X * segment.pose(0.0);
    sum = sum + X * segment.getInertia();
  }
  if (!result.bodies.empty()) set_mass(sum, &result.bodies.back());
  result.R_tip = to_eigen(X.M);
  result.p_tip = to_eigen(X.p);
  return result;
}

}  // namespace limber::controller
