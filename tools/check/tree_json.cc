#include "tools/check/tree_json.h"

#include "tools/check/json.h"

namespace limber {
namespace {

const char* word_of(int type) {
  switch (type) {
    case urdf::Joint::REVOLUTE:
      return "revolute";
    case urdf::Joint::CONTINUOUS:
      return "continuous";
    case urdf::Joint::PRISMATIC:
      return "prismatic";
    default:
      return "fixed";
  }
}

std::string vector_json(const urdf::Vector3& v) { return json::numbers({v.x, v.y, v.z}); }

json::Members pose_members(const urdf::Pose& pose) {
  const urdf::Rotation& q = pose.rotation;
  return {{"p_m", vector_json(pose.position)}, {"quat_xyzw", json::numbers({q.x, q.y, q.z, q.w})}};
}

std::string joint_json(const urdf::Joint& joint) {
  json::Members members = pose_members(joint.parent_to_joint_origin_transform);
  members.insert(members.begin(), {{"name", json::text(joint.name)},
                                   {"type", json::text(word_of(joint.type))},
                                   {"parent", json::text(joint.parent_link_name)},
                                   {"child", json::text(joint.child_link_name)}});
  members.emplace_back("axis", vector_json(joint.axis));
  return json::object(members);
}

std::string inertial_json(const std::string& link, const urdf::Inertial& inertial) {
  json::Members members = pose_members(inertial.origin);
  members.insert(members.begin(),
                 {{"link", json::text(link)}, {"mass_kg", json::number(inertial.mass)}});
  members.emplace_back("xx_xy_xz_yy_yz_zz_kgm2",
                       json::numbers({inertial.ixx, inertial.ixy, inertial.ixz, inertial.iyy,
                                      inertial.iyz, inertial.izz}));
  return json::object(members);
}

}  // namespace

std::string tree_json(const urdf::ModelInterface& model) {
  std::vector<std::string> joints;
  for (const auto& [name, joint] : model.joints_) joints.push_back(joint_json(*joint));
  std::vector<std::string> inertials;
  for (const auto& [name, link] : model.links_) {
    if (link->inertial) inertials.push_back(inertial_json(name, *link->inertial));
  }
  return json::object({{"joints", json::list(joints)}, {"inertials", json::list(inertials)}});
}

}  // namespace limber
