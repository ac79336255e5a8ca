// The tree that tools are given: what of a file is in it, and as what.
#include <gtest/gtest.h>
#include <urdf_model/model.h>

#include "robots/loader/load_robot.h"
#include "tests/support/mutation.h"

namespace limber::test_urdf_model {
namespace {

const double kGravity[3] = {0.0, 0.0, -9.81};

// base -turn-> arm -grip-> finger; base -post-> camera -bad-> lens
constexpr const char* kArm = R"(<robot name="r">
  <link name="base"><inertial><mass value="9"/></inertial></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="arm"/>
    <origin xyz="0 0 1" rpy="0 0 3.141592653589793"/><axis xyz="0 2 0"/>
    <limit lower="-1" upper="1" effort="5" velocity="2"/></joint>
  <link name="arm"><inertial><origin xyz="0.1 0 0"/><mass value="2"/>
    <inertia ixx="3" ixy="0.1" ixz="0.2" iyy="4" iyz="0.3" izz="5"/></inertial></link>
  <joint name="grip" type="revolute"><parent link="arm"/><child link="finger"/>
    <axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="5" velocity="2"/></joint>
  <link name="finger"/>
  <joint name="post" type="prismatic"><parent link="base"/><child link="camera"/>
    <origin xyz="-1 2e-1 +3"/></joint>
  <link name="camera"/>
  <joint name="bad" type="fixed"><parent link="camera"/><child link="lens"/>
    <origin xyz="0 0 1,5"/></joint>
  <link name="lens"/>
</robot>)";

std::shared_ptr<const urdf::ModelInterface> model() {
  const testing::TemporaryFolder folder;
  return load_urdf(folder.write("arm.urdf", kArm), "base", "arm", kGravity).model;
}

TEST(UrdfModel, OnlyJointsOfTheArmMove) {
  const auto tree = model();
  EXPECT_EQ(tree->getJoint("turn")->type, urdf::Joint::REVOLUTE);
  EXPECT_EQ(tree->getJoint("turn")->axis.y, 2.0);
  for (const char* frozen : {"grip", "post"})
    EXPECT_EQ(tree->getJoint(frozen)->type, urdf::Joint::FIXED) << frozen;
  EXPECT_EQ(tree->getLink("finger")->getParent()->name, "arm");
}

TEST(UrdfModel, PlacesWhatIsOfNoEffectWhereItCan) {
  const auto tree = model();
  const urdf::Pose& pose = tree->getJoint("post")->parent_to_joint_origin_transform;
  EXPECT_EQ(pose.position.x, -1.0);
  EXPECT_EQ(pose.position.y, 0.2);
  EXPECT_EQ(pose.position.z, 3.0);
  EXPECT_EQ(tree->getJoint("bad"), nullptr);
  EXPECT_NE(tree->getLink("lens"), nullptr);
}

TEST(UrdfModel, OnlyLinksThatMoveHaveInertia) {
  const auto tree = model();
  EXPECT_EQ(tree->getLink("base")->inertial, nullptr);
  const urdf::Inertial& arm = *tree->getLink("arm")->inertial;
  EXPECT_EQ(arm.mass, 2.0);
  EXPECT_EQ(arm.origin.position.x, 0.1);
  const double tensor[] = {arm.ixx, arm.ixy, arm.ixz, arm.iyy, arm.iyz, arm.izz};
  const double written[] = {3.0, 0.1, 0.2, 4.0, 0.3, 5.0};
  for (int i = 0; i < 6; ++i) EXPECT_EQ(tensor[i], written[i]) << i;
}

}  // namespace
}  // namespace limber::test_urdf_model
