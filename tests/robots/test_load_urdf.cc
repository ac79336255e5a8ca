// What a URDF says becomes M(q) and g(q): held against closed forms and against arms merged by
// hand.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <limits>
#include <sstream>

#include "robots/loader/load_robot.h"
#include "robots/loader/sample_pose.h"
#include "tests/robots/arm_terms.h"
#include "tests/support/mutation.h"
#include "tests/support/source_path.h"

namespace limber::test_load_urdf {
namespace {

using testing::Terms;
using testing::terms_at;

constexpr double kG = 9.81;
const double kDown[3] = {0.0, 0.0, -kG};

std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                  const std::string& child, const std::string& origin, const std::string& axis) {
  std::string text = "<joint name='" + name + "' type='" + type + "'><parent link='" + parent +
                     "'/><child link='" + child + "'/><origin " + origin + "/>";
  if (!axis.empty()) text += "<axis xyz='" + axis + "'/>";
  if (type == "revolute" || type == "prismatic")
    text += "<limit lower='-1.5' upper='1.5' effort='50' velocity='3'/>";
  return text + "</joint>\n";
}

std::string body(const std::string& name, const std::string& mass, const std::string& origin,
                 const std::string& diagonal = "0.01 0.02 0.025") {
  std::istringstream words(diagonal);
  std::string ixx, iyy, izz;
  words >> ixx >> iyy >> izz;
  return "<link name='" + name + "'><inertial><origin " + origin + "/><mass value='" + mass +
         "'/><inertia ixx='" + ixx + "' ixy='0' ixz='0' iyy='" + iyy + "' iyz='0' izz='" + izz +
         "'/></inertial></link>\n";
}

std::string bare(const std::string& name) { return "<link name='" + name + "'/>\n"; }

LoadedRobot load(const std::string& parts, const std::string& base, const std::string& tip,
                 const double (&gravity)[3] = kDown) {
  const testing::TemporaryFolder folder;
  return load_urdf(folder.write("arm.urdf", "<robot name='arm'>" + parts + "</robot>"), base, tip,
                   gravity);
}

void expect_same(const LoadedRobot& a, const LoadedRobot& b) {
  for (unsigned i = 0; i < 20; ++i) {
    const std::vector<double> pose = sample_pose(a.robot, i);
    const Terms one = terms_at(a, pose);
    const Terms other = terms_at(b, pose);
    EXPECT_LT((one.M - other.M).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT((one.g - other.g).cwiseAbs().maxCoeff(), 1e-11);
    EXPECT_LT((one.p_BT - other.p_BT).norm(), 1e-12);
    EXPECT_LT((one.R_BT - other.R_BT).norm(), 1e-12);
  }
}

bool noted(const LoadedRobot& robot, const std::string& part) {
  for (const std::string& note : robot.notes) {
    if (note.find(part) != std::string::npos) return true;
  }
  return false;
}

TEST(LoadUrdf, PendulumHasItsClosedForm) {
  // Axis y, centre of mass on x: M = Iyy + m l^2, and the torque that holds it up is -m g l cos q.
  const LoadedRobot arm = load(bare("base") + joint("j", "revolute", "base", "rod", "", "0 1 0") +
                                   body("rod", "2", "xyz='0.3 0 0'"),
                               "base", "rod");
  for (const double q : {-1.2, 0.0, 0.7}) {
    const Terms terms = terms_at(arm, {q});
    EXPECT_NEAR(terms.M(0, 0), 0.02 + 2 * 0.09, 1e-14);
    EXPECT_NEAR(terms.g[0], -2 * kG * 0.3 * std::cos(q), 1e-13);
  }
}

// A bare & is refused where it could become part of a name, not where nobody reads it.
TEST(LoadUrdf, CommentsMayHoldAnything) {
  const std::string arm = bare("base") +
                          joint("j", "revolute", "base", "a", "xyz='0 0 0'", "0 0 1") +
                          body("a", "1", "xyz='0 0 0'");
  EXPECT_EQ(load("<!-- links & joints <&> -->" + arm + "<!-- & -->", "base", "a").robot.size(), 1);
}

TEST(LoadUrdf, InertiaIsTurnedWithItsOrigin) {
  // Seen along the joint axis (x of the link): the tensor turned by a about z has
  // Ixx' = Ixx cos^2 a + Iyy sin^2 a. About an axis through the centre of mass nothing else counts.
  const double a = 0.4;
  const LoadedRobot arm = load(
      bare("base") + joint("j", "revolute", "base", "rod", "", "1 0 0") +
          body("rod", "2", "xyz='0.3 0 0' rpy='0 0 " + std::to_string(a) + "'", "0.01 0.02 0.025"),
      "base", "rod");
  const double c = std::cos(a);
  const double s = std::sin(a);
  EXPECT_NEAR(terms_at(arm, {0.5}).M(0, 0), 0.01 * c * c + 0.02 * s * s, 1e-14);
}

TEST(LoadUrdf, PrismaticJointCarriesWeight) {
  // A slide tilted by 30 degrees from the vertical lifts m g cos 30.
  const LoadedRobot arm =
      load(bare("base") +
               joint("lift", "prismatic", "base", "car", "rpy='0.5235987755982988 0 0'", "0 0 1") +
               body("car", "3", "xyz='0.1 0.2 0'"),
           "base", "car");
  EXPECT_EQ(arm.robot.joints[0].type, JointType::kPrismatic);
  const Terms terms = terms_at(arm, {0.5});
  EXPECT_NEAR(terms.M(0, 0), 3.0, 1e-14);
  EXPECT_NEAR(terms.g[0], 3.0 * kG * std::sqrt(0.75), 1e-13);
  EXPECT_NEAR(terms.p_BT.z(), 0.5 * std::sqrt(0.75), 1e-14);
  EXPECT_NEAR(terms.p_BT.y(), -0.5 * 0.5, 1e-14);
}

TEST(LoadUrdf, ContinuousJointHasNoEnds) {
  const LoadedRobot arm = load(bare("base") + joint("j", "continuous", "base", "rod", "", "0 0 1") +
                                   body("rod", "2", "xyz='0.3 0 0'"),
                               "base", "rod");
  EXPECT_EQ(arm.robot.joints[0].type, JointType::kContinuous);
  EXPECT_EQ(arm.robot.joints[0].position_min, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(arm.robot.joints[0].position_max, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(noted(arm, "no <limit>"));
  EXPECT_NEAR(terms_at(arm, {40.0}).p_BT.norm(), 0.0, 1e-15);
}

TEST(LoadUrdf, AxisDefaultsToXAsTheFormatSays) {
  const LoadedRobot arm = load(bare("base") + joint("j", "revolute", "base", "rod", "", "") +
                                   body("rod", "2", "xyz='0 0.3 0'"),
                               "base", "rod");
  EXPECT_NEAR(terms_at(arm, {0.0}).M(0, 0), 0.01 + 2 * 0.09, 1e-14);
}

TEST(LoadUrdf, AxisIsNormalised) {
  const auto arm = [](const std::string& axis) {
    return load(bare("base") + joint("j", "prismatic", "base", "car", "rpy='0.1 0.2 0.3'", axis) +
                    body("car", "2", "xyz='0.3 0 0'"),
                "base", "car");
  };
  const LoadedRobot longer = arm("0 3 4");
  expect_same(longer, arm("0 0.6 0.8"));
  EXPECT_TRUE(noted(longer, "axis of length 5 normalised"));
  EXPECT_NEAR(terms_at(longer, {0.7}).p_BT.norm(), 0.7, 1e-14);
}

TEST(LoadUrdf, FixedJointsInsideTheChainAreAsIfMerged) {
  const std::string start = bare("base") + joint("a", "revolute", "base", "one", "", "0 1 0") +
                            body("one", "1", "xyz='0.1 0 0'");
  const LoadedRobot with =
      load(start + joint("f", "fixed", "one", "plate", "xyz='0.2 0 0' rpy='0 0 0.5'", "") +
               bare("plate") + joint("b", "revolute", "plate", "two", "xyz='0.1 0 0'", "0 0 1") +
               body("two", "1", "xyz='0.1 0 0.05'"),
           "base", "two");
  char origin[128];
  std::snprintf(origin, sizeof origin, "xyz='%.17g %.17g 0' rpy='0 0 0.5'",
                0.2 + 0.1 * std::cos(0.5), 0.1 * std::sin(0.5));
  const LoadedRobot without = load(start + joint("b", "revolute", "one", "two", origin, "0 0 1") +
                                       body("two", "1", "xyz='0.1 0 0.05'"),
                                   "base", "two");
  expect_same(with, without);
  EXPECT_EQ(with.segment_links, (std::vector<std::string>{"one", "plate", "two"}));
}

/// Hand with a tool whose load must appear in the hand: mass m2 at p in hand axes, turned by R.
TEST(LoadUrdf, BranchesAreCarriedAsLoad) {
  const std::string start = bare("base") + joint("a", "revolute", "base", "one", "", "0 1 0") +
                            body("one", "1", "xyz='0.1 0 0'") +
                            joint("b", "revolute", "one", "hand", "xyz='0.2 0 0'", "1 0 0");
  const std::string hand = body("hand", "0.5", "xyz='0.05 0 0'", "0.001 0.002 0.0025");
  const std::string gripper =
      joint("mount", "fixed", "hand", "gripper", "xyz='0.1 0 0.02' rpy='0.3 0 0'", "") +
      body("gripper", "0.3", "xyz='0 0 0.04' rpy='0 0.2 0'", "0.0002 0.0003 0.0004") +
      joint("finger_slide", "prismatic", "gripper", "finger", "xyz='0 0.03 0.06'", "0 1 0") +
      body("finger", "0.1", "xyz='0 0 0.01'", "0.00002 0.00003 0.00004");
  const LoadedRobot arm = load(start + hand + gripper, "base", "hand");

  // By hand: add the parts about the common centre of mass, in axes of the hand.
  using Eigen::AngleAxisd;
  using Eigen::Matrix3d;
  using Eigen::Vector3d;
  const Matrix3d R_HG = AngleAxisd(0.3, Vector3d::UnitX()).toRotationMatrix();
  const Matrix3d R_GI = AngleAxisd(0.2, Vector3d::UnitY()).toRotationMatrix();
  const Vector3d p_HG(0.1, 0.0, 0.02);
  const double m[3] = {0.5, 0.3, 0.1};
  const Vector3d c[3] = {Vector3d(0.05, 0, 0), p_HG + R_HG * Vector3d(0, 0, 0.04),
                         p_HG + R_HG * Vector3d(0, 0.03, 0.07)};
  const Matrix3d R[3] = {Matrix3d::Identity(), R_HG * R_GI, R_HG};
  const Vector3d I[3] = {{0.001, 0.002, 0.0025}, {0.0002, 0.0003, 0.0004}, {2e-5, 3e-5, 4e-5}};
  const double mass = m[0] + m[1] + m[2];
  const Vector3d center = (m[0] * c[0] + m[1] * c[1] + m[2] * c[2]) / mass;
  Matrix3d tensor = Matrix3d::Zero();
  for (int i = 0; i < 3; ++i) {
    const Vector3d d = c[i] - center;
    tensor += R[i] * I[i].asDiagonal() * R[i].transpose() +
              m[i] * (d.squaredNorm() * Matrix3d::Identity() - d * d.transpose());
  }
  char merged[512];
  std::snprintf(merged, sizeof merged,
                "<link name='hand'><inertial><origin xyz='%.17g %.17g %.17g'/><mass value='%.17g'/>"
                "<inertia ixx='%.17g' ixy='%.17g' ixz='%.17g' iyy='%.17g' iyz='%.17g' "
                "izz='%.17g'/></inertial></link>",
                center.x(), center.y(), center.z(), mass, tensor(0, 0), tensor(0, 1), tensor(0, 2),
                tensor(1, 1), tensor(1, 2), tensor(2, 2));
  expect_same(arm, load(start + merged, "base", "hand"));
  EXPECT_TRUE(noted(arm, "link 'hand': carries 0.4 kg"));
  EXPECT_TRUE(noted(arm, "not part of the arm, frozen at zero: 'finger_slide' (line "));
}

TEST(LoadUrdf, WhatHangsFromAMiddleLinkCountsToo) {
  const auto arm = [](const std::string& extra, const std::string& mass, const std::string& com,
                      const std::string& diagonal) {
    return load(bare("base") + joint("a", "revolute", "base", "one", "", "0 1 0") +
                    body("one", mass, com, diagonal) + extra +
                    joint("b", "revolute", "one", "two", "xyz='0.3 0 0'", "0 1 0") +
                    body("two", "1", "xyz='0.1 0 0'"),
                "base", "two");
  };
  // Two equal bodies 0.2 m apart are one of twice the mass in the middle, with m d^2 more inertia
  // across the line between them.
  const std::string box = joint("f", "fixed", "one", "box", "xyz='0.2 0 0'", "") +
                          body("box", "1", "xyz='0 0 0'", "0.01 0.02 0.025");
  expect_same(arm(box, "1", "xyz='0 0 0'", "0.01 0.02 0.025"),
              arm("", "2", "xyz='0.1 0 0'", "0.02 0.06 0.07"));
}

TEST(LoadUrdf, GravityIsTurnedIntoABaseThatIsTilted) {
  const std::string rest = joint("a", "revolute", "base", "one", "xyz='0 0 0.1'", "0 1 0") +
                           body("one", "1", "xyz='0.1 0 0'") +
                           joint("b", "revolute", "one", "two", "xyz='0.3 0 0'", "1 0 0") +
                           body("two", "1", "xyz='0.1 0.1 0'");
  const std::string tilted =
      bare("root") + joint("n", "fixed", "root", "plate", "rpy='0.9 0 0'", "") + bare("plate") +
      joint("m", "fixed", "plate", "base", "xyz='1 2 3' rpy='0.4 -0.7 1.1'", "") + bare("base") +
      rest;
  const LoadedRobot from_base = load(tilted, "base", "two");
  const LoadedRobot from_root = load(tilted, "root", "two");
  const Eigen::Matrix3d R = (Eigen::AngleAxisd(0.9, Eigen::Vector3d::UnitX()) *
                             Eigen::AngleAxisd(1.1, Eigen::Vector3d::UnitZ()) *
                             Eigen::AngleAxisd(-0.7, Eigen::Vector3d::UnitY()) *
                             Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX()))
                                .toRotationMatrix();
  const Eigen::Vector3d expected = R.transpose() * Eigen::Vector3d(0, 0, -kG);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(from_base.robot.gravity[i], expected[i], 1e-14);
    EXPECT_EQ(from_root.robot.gravity[i], kDown[i]);
  }
  for (unsigned i = 0; i < 10; ++i) {
    const auto pose = sample_pose(from_base.robot, i);
    EXPECT_LT((terms_at(from_base, pose).g - terms_at(from_root, pose).g).norm(), 1e-13);
  }
}

TEST(LoadUrdf, MovingJointsBelowTheBaseAreFrozen) {
  const LoadedRobot arm = load(
      bare("floor") +
          joint("lift", "prismatic", "floor", "base", "rpy='1.5707963267948966 0 0'", "0 0 1") +
          bare("base") + joint("a", "revolute", "base", "one", "", "0 1 0") +
          body("one", "1", "xyz='0.1 0 0'"),
      "base", "one");
  EXPECT_EQ(arm.robot.size(), 1);
  EXPECT_TRUE(noted(arm, "arm.urdf:2: joint 'lift': between root and base: frozen at zero"));
  EXPECT_NEAR(arm.robot.gravity[1], -kG, 1e-14);
}

TEST(LoadUrdf, MasslessLinksBetweenJointsAreFine) {
  const LoadedRobot wrist = load(
      bare("base") + joint("a", "revolute", "base", "one", "", "0 0 1") + bare("one") +
          joint("b", "revolute", "one", "two", "", "0 1 0") + bare("two") +
          joint("c", "revolute", "two", "hand", "", "1 0 0") + body("hand", "1", "xyz='0.1 0 0'"),
      "base", "hand");
  // At zero the axes are z, y, x through one point: M is the inertia about that point, reversed.
  const Terms terms = terms_at(wrist, {0, 0, 0});
  EXPECT_NEAR(terms.M(0, 0), 0.025 + 0.01, 1e-14);
  EXPECT_NEAR(terms.M(1, 1), 0.02 + 0.01, 1e-14);
  EXPECT_NEAR(terms.M(2, 2), 0.01, 1e-14);
}

// As exporters write frames that are no bodies, and other simulators their friction.
TEST(LoadUrdf, LinksOfNoMassAndFiguresOfOtherProgramsAreFine) {
  const std::string arm = bare("base") + body("link", "2", "xyz='0.1 0 0.2'");
  const std::string hinge = joint("hinge", "revolute", "base", "link", "xyz='0 0 1'", "0 1 0");
  const std::string mount = joint("mount", "fixed", "link", "tip", "xyz='0.3 0 0'", "");
  const std::string zero = body("tip", "0.0", "xyz='0 0 0'", "0 0 0");
  const std::string figures = "<dynamics damping='1' mu_viscous='x' D='0' K='7000'/></joint>";
  const std::string annotated = hinge.substr(0, hinge.rfind("</joint>")) + figures;
  expect_same(load(arm + annotated + mount + zero, "base", "tip"),
              load(arm + hinge + mount + bare("tip"), "base", "tip"));
}

TEST(LoadUrdf, TwoJointsOnOneLineCannotBeToldApart) {
  const std::string parts = bare("base") + joint("a", "revolute", "base", "one", "", "0 0 1") +
                            bare("one") + joint("b", "revolute", "one", "hand", "", "0 0 1") +
                            body("hand", "1", "xyz='0.1 0 0'");
  const std::string complaint = testing::complaint_of([&] { load(parts, "base", "hand"); });
  EXPECT_NE(complaint.find("moves no mass"), std::string::npos) << complaint;
}

TEST(LoadUrdf, SixteenJoints) {
  std::string parts = bare("l0");
  for (int i = 0; i < 16; ++i) {
    const std::string from = "l" + std::to_string(i);
    const std::string to = "l" + std::to_string(i + 1);
    parts += joint("j" + std::to_string(i), "revolute", from, to, "xyz='0.1 0 0'",
                   i % 2 == 0 ? "0 0 1" : "0 1 0") +
             body(to, "0.2", "xyz='0.05 0 0'", "0.001 0.001 0.001");
  }
  const LoadedRobot arm = load(parts, "l0", "l16");
  ASSERT_EQ(arm.robot.size(), 16);
  EXPECT_EQ(arm.robot.joints[15].name, "j15");
  const Terms terms = terms_at(arm, std::vector<double>(16, 0.0));
  EXPECT_NEAR(terms.p_BT.x(), 1.6, 1e-14);
  // The last joint alone: inertia 0.001 + 0.2 * 0.05^2 about its axis; held against 0.2 kg at 0.05
  // m.
  EXPECT_NEAR(terms.M(15, 15), 0.0015, 1e-14);
  EXPECT_NEAR(terms.g[15], -0.2 * kG * 0.05, 1e-13);
}

TEST(LoadUrdf, BareUrdfHasNoDrivesAndAHomeInside) {
  const LoadedRobot arm =
      load_urdf(source_path("tests/robots/data/arm/robot.urdf"), "world", "hand", kDown);
  EXPECT_FALSE(arm.robot.has_drives);
  EXPECT_EQ(arm.robot.joints[0].home, 0.0);
  EXPECT_EQ(arm.robot.joints[0].torque_limit_Nm, 20.0);
  EXPECT_EQ(arm.robot.joints[1].velocity_limit, 0.5);
  EXPECT_EQ(arm.robot.gains.K_q.size(), 3u);
  EXPECT_TRUE(
      noted(arm,
            "robot.urdf:57: joint: not part of the arm, frozen at zero: 'finger_joint' (line 57, "
            "its <mimic> is ignored)"));
}

}  // namespace
}  // namespace limber::test_load_urdf
