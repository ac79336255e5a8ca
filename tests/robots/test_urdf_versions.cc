// URDF 1.1 and 1.2: the same arm, its rotations by quaternions.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "robots/loader/load_robot.h"
#include "robots/loader/sample_pose.h"
#include "tests/robots/arm_terms.h"
#include "tests/support/mutation.h"

namespace limber::test_urdf_versions {
namespace {

using testing::terms_at;

const double kGravity[3] = {0.0, 0.0, -9.81};

std::string arm(const std::string& version, const std::string& turn,
                const std::string& inertial_turn = "") {
  return "<robot name='r'" + version +
         R"(><link name="base"/>
  <joint name="a" type="revolute"><parent link="base"/><child link="one"/>
    <origin xyz="0.1 0 0.2" )" +
         turn +
         R"(/><axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="9" velocity="3"/></joint>
  <link name="one"><inertial><origin xyz="0 0 0.1" )" +
         inertial_turn + R"(/><mass value="2"/>
    <inertia ixx="0.03" ixy="0.001" ixz="0" iyy="0.02" iyz="0" izz="0.01"/></inertial></link>
  <joint name="b" type="revolute"><parent link="one"/><child link="two"/>
    <origin xyz="0 0 0.3"/><axis xyz="1 0 0"/>
    <limit lower="-2" upper="2" effort="9" velocity="3"/></joint>
  <link name="two"><inertial><origin xyz="0 0.05 0.1"/><mass value="1"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.005"/></inertial>
    <collision><geometry><capsule radius="0.03" length="0.2"/></geometry></collision></link>
</robot>)";
}

LoadedRobot load(const std::string& text) {
  const testing::TemporaryFolder folder;
  return load_urdf(folder.write("robot.urdf", text), "base", "two", kGravity);
}

void expect_same(const LoadedRobot& one, const LoadedRobot& other) {
  for (unsigned i = 0; i < 10; ++i) {
    const auto a = terms_at(one, sample_pose(one.robot, i));
    const auto b = terms_at(other, sample_pose(one.robot, i));
    EXPECT_LT((a.M - b.M).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT((a.g - b.g).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT((a.p_BT - b.p_BT).norm(), 1e-12);
  }
}

TEST(UrdfVersions, TheNumberAloneChangesNothing) {
  for (const char* version : {" version='1.0'", " version='1.1'", " version='1.2'"})
    expect_same(load(arm(version, "rpy='0.1 0.2 0.3'")), load(arm("", "rpy='0.1 0.2 0.3'")));
}

// Half the angle about the axis: q = (n sin(a/2), cos(a/2)). URDF's rpy: Rz(y) Ry(p) Rx(r).
TEST(UrdfVersions, QuaternionsTurnAsRollPitchAndYawDo) {
  const auto about = [](int axis, double angle) {
    double q[4] = {0.0, 0.0, 0.0, std::cos(angle / 2.0)};
    q[axis] = std::sin(angle / 2.0);
    return fmt::format("quat_xyzw='{} {} {} {}'", q[0], q[1], q[2], q[3]);
  };
  for (const double angle : {0.7, -2.4, std::numbers::pi / 2.0, std::numbers::pi}) {
    for (int axis = 0; axis < 3; ++axis) {
      std::array<double, 3> rpy = {};
      rpy[static_cast<std::size_t>(axis)] = angle;
      const std::string same = fmt::format("rpy='{} {} {}'", rpy[0], rpy[1], rpy[2]);
      expect_same(load(arm("", about(axis, angle), about(axis, angle))), load(arm("", same, same)));
    }
  }
}

// Pitch at a quarter turn, where roll and yaw are one: (r, p, y) = (0.4, pi/2, 0.9).
TEST(UrdfVersions, AlsoWhereRollAndYawAreOne) {
  const double r = 0.2, p = std::numbers::pi / 4.0, y = 0.45;  // half angles
  const double q[4] = {
      std::sin(r) * std::cos(p) * std::cos(y) - std::cos(r) * std::sin(p) * std::sin(y),
      std::cos(r) * std::sin(p) * std::cos(y) + std::sin(r) * std::cos(p) * std::sin(y),
      std::cos(r) * std::cos(p) * std::sin(y) - std::sin(r) * std::sin(p) * std::cos(y),
      std::cos(r) * std::cos(p) * std::cos(y) + std::sin(r) * std::sin(p) * std::sin(y)};
  expect_same(load(arm("", fmt::format("quat_xyzw='{} {} {} {}'", q[0], q[1], q[2], q[3]))),
              load(arm("", fmt::format("rpy='0.4 {} 0.9'", std::numbers::pi / 2.0))));
}

}  // namespace
}  // namespace limber::test_urdf_versions
