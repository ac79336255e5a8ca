#include "robots/loader/urdf_to_kdl.h"

#include <urdf_model/joint.h>

#include <vector>

namespace limber {
namespace {

KDL::Vector to_kdl(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

/// The URDF gives the tensor about the centre of mass in axes of <inertial><origin>; KDL wants it
/// about the centre of mass in link axes.
KDL::RigidBodyInertia to_kdl(const urdf::Inertial& inertial) {
  const KDL::Frame X_LI = limber::to_kdl(inertial.origin);
  const KDL::RotationalInertia tensor(inertial.ixx, inertial.iyy, inertial.izz, inertial.ixy,
                                      inertial.ixz, inertial.iyz);
  const KDL::RigidBodyInertia turned =
      X_LI.M * KDL::RigidBodyInertia(inertial.mass, KDL::Vector::Zero(), tensor);
  return KDL::RigidBodyInertia(inertial.mass, X_LI.p, turned.getRotationalInertia());
}

}  // namespace

KDL::Frame to_kdl(const urdf::Pose& pose) {
  double x = 0.0, y = 0.0, z = 0.0, w = 1.0;
  pose.rotation.getQuaternion(x, y, z, w);
  return {KDL::Rotation::Quaternion(x, y, z, w), to_kdl(pose.position)};
}

bool moves(const urdf::Joint& joint) { return joint.type != urdf::Joint::FIXED; }

KDL::Joint to_kdl(const urdf::Joint& joint) {
  if (!moves(joint)) return KDL::Joint(joint.name, KDL::Joint::Fixed);
  const KDL::Frame X_PJ = to_kdl(joint.parent_to_joint_origin_transform);
  const auto type =
      joint.type == urdf::Joint::PRISMATIC ? KDL::Joint::TransAxis : KDL::Joint::RotAxis;
  KDL::Vector axis = to_kdl(joint.axis);
  axis.Normalize();
  return KDL::Joint(joint.name, X_PJ.p, X_PJ.M * axis, type);
}

Load load_of(const urdf::Link& link, const urdf::Link* next) {
  Load load;
  if (link.inertial) load.inertia = to_kdl(*link.inertial);
  struct Open {
    const urdf::Link* link;
    KDL::Frame X_LO;
  };
  std::vector<Open> open;  // a stack of our own: branches may be thousands of links long
  auto hang = [&](const urdf::Link& from, const KDL::Frame& X_LF) {
    for (const auto& child : from.child_links) {
      if (child.get() == next) continue;
      const urdf::Joint& joint = *child->parent_joint;
      open.push_back({child.get(), X_LF * to_kdl(joint.parent_to_joint_origin_transform)});
    }
  };
  hang(link, KDL::Frame::Identity());
  while (!open.empty()) {
    const Open here = open.back();
    open.pop_back();
    if (here.link->inertial) {
      load.inertia = load.inertia + here.X_LO * to_kdl(*here.link->inertial);
      load.branch_mass_kg += here.link->inertial->mass;
    }
    hang(*here.link, here.X_LO);
  }
  return load;
}

}  // namespace limber
