#include "dynamics/body_chain.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <kdl/chain.hpp>

#include "common/config_error.h"
#include "common/joints.h"

namespace limber::dynamics {
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

/// Inertia of a point mass of 1 kg at `r`, about the origin.
Eigen::Matrix3d point_inertia(const Eigen::Vector3d& r) {
  return r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose();
}

MassProperties mass_of(const KDL::RigidBodyInertia& sum) {
  MassProperties result;
  result.mass = sum.getMass();
  if (!(result.mass > 0.0)) return result;
  result.com = to_eigen(sum.getCOG());
  result.inertia = Eigen::Map<const Eigen::Matrix3d>(sum.getRotationalInertia().data) -
                   result.mass * point_inertia(result.com);
  return result;
}

}  // namespace

MassProperties with_point_mass(const MassProperties& body, double mass,
                               const Eigen::Vector3d& position) noexcept {
  MassProperties result = body;
  result.mass += mass;
  if (!(result.mass > 0.0)) return body;
  result.com = (body.mass * body.com + mass * position) / result.mass;
  result.inertia += body.mass * point_inertia(body.com - result.com) +
                    mass * point_inertia(position - result.com);
  return result;
}

double Body::own_inertia() const noexcept {
  if (prismatic) return mass.mass;
  return mass.inertia(2, 2) + mass.mass * mass.com.head<2>().squaredNorm();
}

BodyChain body_chain(const KDL::Chain& chain, int joints) {
  BodyChain result;
  KDL::Frame X = KDL::Frame::Identity();  // end of the segments so far in the last body's frame
  KDL::RigidBodyInertia sum = KDL::RigidBodyInertia::Zero();
  const auto close_body = [&] {
    if (!result.bodies.empty()) result.bodies.back().mass = mass_of(sum);
    sum = KDL::RigidBodyInertia::Zero();
  };
  for (const KDL::Segment& segment : chain.segments) {
    const KDL::Joint& joint = segment.getJoint();
    if (joint.getType() != KDL::Joint::Fixed) {
      check(joint);
      close_body();
      const KDL::Frame X_joint(with_z(joint.JointAxis()), joint.JointOrigin());
      const KDL::Frame X_body = X * X_joint;
      result.bodies.push_back(
          {.prismatic = slides(joint), .R = to_eigen(X_body.M), .p = to_eigen(X_body.p)});
      X = X_joint.Inverse();
    }
    X = X * segment.pose(0.0);
    sum = sum + X * segment.getInertia();
    result.frames.push_back({result.size() - 1, to_eigen(X.M), to_eigen(X.p)});
  }
  close_body();
  if (result.size() == joints && joints >= 1 && joints <= kMaxJoints) return result;
  throw ConfigError(fmt::format(
      "the chain from base to tip has {} moving joints and the robot {}; 1 to {}, and as many, are "
      "allowed",
      result.size(), joints, kMaxJoints));
}

}  // namespace limber::dynamics
