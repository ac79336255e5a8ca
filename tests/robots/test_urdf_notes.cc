// URDFs as vendors publish them: what is odd, or wrong where it does not count, is told with its
// place and changes nothing; what counts is still refused.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "robots/loader/load_robot.h"
#include "robots/loader/sample_pose.h"
#include "tests/robots/arm_terms.h"
#include "tests/support/mutation.h"
#include "tests/support/source_path.h"

namespace limber::test_urdf_notes {
namespace {

using testing::Mutation;
using testing::terms_at;

const double kGravity[3] = {0.0, 0.0, -9.81};
const std::string kArm = source_path("tests/robots/data/arm");

std::string good_urdf() { return testing::read_text(kArm + "/robot.urdf"); }

LoadedRobot load(const std::string& text, const std::string& base = "base") {
  const testing::TemporaryFolder folder;
  return load_urdf(folder.write("robot.urdf", text), base, "hand", kGravity);
}

bool noted(const LoadedRobot& robot, const std::string& part) {
  return std::ranges::any_of(
      robot.notes, [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

std::string changed(std::string text, const std::string& find, const std::string& replace) {
  return testing::apply(text, {"", find, replace, ""}).text;
}

void expect_same(const LoadedRobot& a, const LoadedRobot& b) {
  for (unsigned i = 0; i < 10; ++i) {
    const auto one = terms_at(a, sample_pose(b.robot, i));
    const auto other = terms_at(b, sample_pose(b.robot, i));
    EXPECT_LT((one.M - other.M).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT((one.g - other.g).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT((one.p_BT - other.p_BT).norm(), 1e-12);
  }
}

/// What does not count: a note, and the same arm.
class UrdfNote : public ::testing::TestWithParam<Mutation> {};

TEST_P(UrdfNote, NamesThePlaceAndChangesNothing) {
  const testing::Mutated odd = testing::apply(good_urdf(), GetParam());
  const LoadedRobot arm = load(odd.text);
  EXPECT_TRUE(noted(arm, "robot.urdf:" + std::to_string(odd.line) + ": ")) << odd.text;
  EXPECT_TRUE(noted(arm, GetParam().expect)) << arm.notes.front();
  EXPECT_TRUE(noted(arm, "(of no effect on this arm)"));
  expect_same(arm, load(good_urdf()));
}

const std::string kStand = R"(<origin xyz="0 0 0.5" rpy="0 0 0.3"/>)";
const std::string kFinger = R"(<limit lower="0" upper="0.04" effort="10" velocity="0.1"/>)";
const std::string kBase = R"(<link name="base"/>)";
const std::string kMassless = R"(<mass value="0"/>)";
const std::string kBox =
    R"(<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>)";
const Mutation kElsewhere[] = {
    {"AxisOfAFixedJoint", kStand, kStand + R"(<axis xyz="0 0 0"/>)",
     "joint 'stand': <axis> xyz: the axis has no length"},
    {"LimitOfAFixedJoint", kStand, kStand + R"(<limit effort="x"/>)",
     R"(joint 'stand': <limit> effort: "x")"},
    {"LimitOfAFrozenJoint", kFinger, R"(<limit effort="many"/>)", "joint 'finger_joint': <limit>"},
    {"AxisOfAFrozenJoint", R"(<axis xyz="0 1 0"/>
    <limit lower="0" upper="0.04")",
     R"(<axis xyz="0 0 0"/><limit lower="0" upper="0.04")", "joint 'finger_joint': <axis>"},
    {"MimicOfAFrozenJoint", R"(multiplier="1")", R"(multiplier="1x")", "<mimic> multiplier"},
    {"VisualInDegrees", R"(rpy="0 1.57 0")", R"(rpy="0 90 0")", "are these degrees?"},
    {"VisualNotANumber", R"(radius="0.03")", R"(radius="thin")", R"(<cylinder> radius: "thin")"},
    {"BaseWithoutMass", kBase, R"(<link name="base"><inertial>)" + kMassless + kBox,
     "link 'base': inertia without mass"},
    {"BaseWithoutInertia", kBase,
     R"(<link name="base"><inertial><mass value="3"/></inertial></link>)",
     "link 'base': <inertial> without <inertia>"},
    {"BaseOfNegativeMass", kBase, R"(<link name="base"><inertial><mass value="-3"/>)" + kBox,
     "link 'base': <mass> value: -3 kg"},
    {"BaseWithUnreadableMass", kBase, R"(<link name="base"><inertial><mass value="1,5"/>)" + kBox,
     R"(link 'base': <mass> value: "1,5" is not a finite number)"},
    {"JointOfABranchOfTheBase", kBase,
     kBase + R"(<joint name="neck" type="hinge"><parent link="base"/><child link="head"/>
     <origin xyz="nan 0 0"/></joint><link name="head"/>)",
     "joint 'neck': type 'hinge'; expected one of"},
    {"PlaceOfABranchOfTheBase", kBase,
     kBase + R"(<joint name="neck" type="fixed"><parent link="base"/><child link="head"/>
     <origin xyz="nan 0 0"/></joint><link name="head"/>)",
     R"(joint 'neck': <origin> xyz: "nan 0 0")", 1},
};
INSTANTIATE_TEST_SUITE_P(Elsewhere, UrdfNote, ::testing::ValuesIn(kElsewhere),
                         testing::MutationName());

/// What counts, and is odd: told, and used as it is.
class UrdfOddity : public ::testing::TestWithParam<Mutation> {};

TEST_P(UrdfOddity, IsTold) {
  const LoadedRobot arm = load(testing::apply(good_urdf(), GetParam()).text);
  EXPECT_TRUE(noted(arm, GetParam().expect)) << GetParam().expect;
  EXPECT_FALSE(noted(arm, "(of no effect on this arm)"));
}

const std::string kUpperLimit = R"(<limit lower="-2" upper="2.5" effort="20" velocity="5"/>)";
const Mutation kOdd[] = {
    {"HeavyAsInIndustry", R"(<mass value="2"/>)", R"(<mass value="1500"/>)",
     "link 'upper': mass 1500 kg; are these grams?"},
    {"MassOnly", R"(<inertia ixx="1e-5" ixy="0" ixz="0" iyy="1e-5" iyz="0" izz="1e-5"/>)",
     R"(<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>)",
     "link 'finger': mass 0.05 kg without inertia: a point mass"},
    {"InertiaOnly", R"(<mass value="2"/>)", R"(<mass value="0"/>)",
     "link 'upper': inertia without mass; used as it is"},
    {"InertiaOfNoBody", R"(izz="0.025")", R"(izz="0.05")",
     "one principal moment exceeds the sum of the others"},
    {"OneMomentSlightlyNegative", R"(ixx="0.004")", R"(ixx="-0.0001")",
     "link 'fore': <inertia>: no body has it: one principal moment is below zero"},
    {"LimitAbsent", kUpperLimit, "", "joint 'turn': no <limit"},
    {"LimitsZero", kUpperLimit, R"(<limit lower="0" upper="0" effort="0" velocity="0"/>)",
     "joint 'turn': <limit>: lower and upper are 0"},
    {"EffortZero", R"(effort="20")", R"(effort="0")", "joint 'turn': <limit> effort: 0: no limit"},
    {"EffortAbsent", R"( effort="20")", "", "joint 'turn': <limit> without effort: no limit"},
    {"VelocityAbsent", R"( velocity="10")", "", "joint 'roll': <limit> without velocity: no limit"},
    {"EndsOfAContinuousJoint", R"(<limit effort="4")", R"(<limit lower="-1" upper="1" effort="4")",
     "joint 'roll': <limit>: lower -1 and upper 1 are ignored"},
    {"FrozenWhereItCannotBe", R"(<limit lower="0" upper="0.04" effort="10" velocity="0.1"/>)",
     R"(<limit lower="0.01" upper="0.04" effort="10" velocity="0.1"/>)",
     "joint 'finger_joint': frozen at zero, which lies outside its limits 0.01 to 0.04"},
    {"SpeedInDegrees", R"(velocity="5")", R"(velocity="180")",
     "180 rad/s is 28.6 turns a second; are these degrees per second? 3.142 rad/s"},
    {"LengthInMillimetres", R"(xyz="0.2 0 0")", R"(xyz="200 0 0")",
     "<origin> xyz: 200 m; are these millimetres? 0.2 m"},
    {"ForeignAttribute", R"(effort="20")", R"(effort="20" drake:acceleration="10")",
     "drake:acceleration: not read: an extension"},
    {"ForeignElement", R"(<link name="world"/>)",
     R"(<link name="world"><acme:origin rpy="9 9 99"/></link>)",
     "<acme:origin>: not read: an extension"},
    {"AccelerationLimit", R"(effort="20")", R"(effort="20" acceleration="10" jerk="3")",
     "acceleration: not read: limber limits position, speed and torque"},
    {"SafetyController", R"(<limit lower="-2")",
     R"(<safety_controller soft_lower_limit="-1" k_velocity="3"/><limit lower="-2")",
     "<safety_controller>: not read: soft limits"},
    {"VelocityZero", R"(velocity="10")", R"(velocity="0")", "joint 'roll': <limit> velocity: 0"},
};
INSTANTIATE_TEST_SUITE_P(Counts, UrdfOddity, ::testing::ValuesIn(kOdd), testing::MutationName());

TEST(UrdfNotes, APlaceholderIsNoLimit) {
  const LoadedRobot arm = load(
      changed(good_urdf(), kUpperLimit, R"(<limit lower="0" upper="0" effort="0" velocity="0"/>)"));
  const JointConfig& joint = arm.robot.joints[0];
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(joint.position_min, -kInfinity);
  EXPECT_EQ(joint.position_max, kInfinity);
  EXPECT_EQ(joint.velocity_limit, kInfinity);
  EXPECT_EQ(joint.torque_limit_Nm, kInfinity);
}

// Inertia without mass turns with its link: about the lowest axis it adds Ixx..Izz, no weight.
TEST(UrdfNotes, InertiaWithoutMassTurnsButWeighsNothing) {
  const std::string spinning =
      changed(good_urdf(), R"(<mass value="0.05"/>)", R"(<mass value="0"/>)");
  std::string absent = good_urdf();
  const auto from = absent.find("<inertial>", absent.find("<link name=\"finger\">"));
  absent.erase(from, absent.find("</inertial>", from) + 11 - from);
  const auto with = terms_at(load(spinning), {0, 0.1, 0});
  const auto without = terms_at(load(absent), {0, 0.1, 0});
  EXPECT_NEAR(with.M(2, 2) - without.M(2, 2), 1e-5, 1e-15);
  EXPECT_LT((with.g - without.g).norm(), 1e-15);
}

/// Two joints about one line, the last with a thin rod that it turns about its own axis.
std::string rod_of(const std::string& moment) {
  return R"(<robot name="r"><link name="base"/><link name="hand">
<inertial><origin xyz="0 0 0.1"/><mass value="1"/>
<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz=")" +
         moment + R"("/></inertial></link>
<joint name="twist" type="continuous"><parent link="base"/><child link="hand"/>
<axis xyz="0 0 1"/><limit effort="1" velocity="1"/></joint></robot>)";
}

TEST(UrdfNotes, AnInertiaThatTakesTheMassMatrixsSignIsRefused) {
  EXPECT_FALSE(noted(load(rod_of("0.0001")), "no body"));
  const std::string complaint = testing::complaint_of([] { load(rod_of("-0.0001")); });
  EXPECT_NE(complaint.find("robot.urdf:3: link 'hand': <inertia>: a principal moment of -0.0001"),
            std::string::npos)
      << complaint;
  EXPECT_NE(complaint.find("smallest eigenvalue -0.0001 at q = [0.000]"), std::string::npos)
      << complaint;
}

// Only at one end of the second joint's travel does the mass matrix lose its sign.
TEST(UrdfNotes, AThousandPosesAreTried) {
  const std::string arm =
      R"(<robot name="r"><link name="base"/><link name="one"/><link name="hand">
<inertial><origin xyz="0.01 0 0"/><mass value="1"/>
<inertia ixx="0.02" ixy="0" ixz="0" iyy="-0.00095" iyz="0" izz="0.02"/></inertial></link>
<joint name="turn" type="revolute"><parent link="base"/><child link="one"/><axis xyz="0 0 1"/>
<limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
<joint name="tilt" type="revolute"><parent link="one"/><child link="hand"/><axis xyz="1 0 0"/>
<limit lower="-1.58" upper="1" effort="1" velocity="1"/></joint></robot>)";
  // About z, at tilt b, the hand has 0.02 cos^2 b - 0.00095 sin^2 b + 1e-4: below zero beyond
  // |b| = 1.364, which none of the first eight poses but many of the thousand reach.
  const std::string complaint = testing::complaint_of([&] { load(arm); });
  EXPECT_NE(complaint.find("link 'hand': <inertia>"), std::string::npos) << complaint;
}

TEST(UrdfNotes, AFarNegativeMomentIsASlipOfSign) {
  EXPECT_NE(testing::complaint_of([] {
              load(changed(good_urdf(), R"(ixx="0.004")", R"(ixx="-0.0005")"));
            }).find("link 'fore': <inertia>: not positive definite"),
            std::string::npos);
}

TEST(UrdfNotes, AnExpandedXacroKeepsItsNamespace) {
  EXPECT_EQ(load(changed(good_urdf(), "<robot name=\"arm\">",
                         "<robot name=\"arm\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\">"))
                .robot.size(),
            3);
}

TEST(UrdfNotes, AXacroFileNamesTheCommandThatExpandsIt) {
  const testing::TemporaryFolder folder;
  const std::string file =
      folder.write("my_arm.urdf.xacro", "<robot xmlns:xacro='x'>\n<xacro:arm/></robot>");
  const std::string complaint =
      testing::complaint_of([&] { load_urdf(file, "base", "hand", kGravity); });
  EXPECT_NE(
      complaint.find(":2: holds xacro macros; expand them first: xacro " + file + " > my_arm.urdf"),
      std::string::npos)
      << complaint;
}

/// A robot folder whose URDF has placeholders.
struct Folder {
  explicit Folder(const std::string& limits) {
    folder.write("robot.urdf", changed(good_urdf(), kUpperLimit,
                                       R"(<limit lower="0" upper="0" effort="1" velocity="0"/>)"));
    folder.write("robot.yaml",
                 changed(testing::read_text(kArm + "/robot.yaml"),
                         "    position_max_rad: 2\n    torque_limit_Nm: 12\n", limits));
  }
  testing::TemporaryFolder folder;
};

TEST(UrdfNotes, ARobotNeedsLimits) {
  const Folder robot("");
  const std::string complaint = testing::complaint_of([&] { load_robot(robot.folder.path()); });
  for (const char* part :
       {"robot.urdf:16: joint 'turn': <limit>: lower and upper are 0",
        "robot.urdf:16: joint 'turn': <limit> velocity: 0", "urdf_limits: ignore"}) {
    EXPECT_NE(complaint.find(part), std::string::npos) << complaint;
  }
}

TEST(UrdfNotes, LimitsOfRobotYamlAlone) {
  const Folder robot(
      "    urdf_limits: ignore\n    position_min_rad: -1\n    position_max_rad: 2\n"
      "    velocity_limit_rad_per_s: 3\n    torque_limit_Nm: 12\n");
  const LoadedRobot arm = load_robot(robot.folder.path());
  const JointConfig& joint = arm.robot.joints[0];
  EXPECT_EQ(joint.position_min, -1.0);
  EXPECT_EQ(joint.position_max, 2.0);
  EXPECT_EQ(joint.velocity_limit, 3.0);
  EXPECT_EQ(joint.torque_limit_Nm, 12.0);  // the URDF's 1 N m was a placeholder
  EXPECT_TRUE(noted(arm, "joint 'turn': <limit> ignored (urdf_limits: ignore)"));
}

TEST(UrdfNotes, WithoutTheUrdfsLimitsAllAreNeeded) {
  const Folder robot("    urdf_limits: ignore\n    position_max_rad: 2\n");
  const std::string complaint = testing::complaint_of([&] { load_robot(robot.folder.path()); });
  EXPECT_NE(complaint.find("joints.turn.urdf_limits: ignore: then robot.yaml gives every limit; "
                           "missing: velocity_limit_rad_per_s, torque_limit_Nm, position_min_rad"),
            std::string::npos)
      << complaint;
}

}  // namespace
}  // namespace limber::test_urdf_notes
