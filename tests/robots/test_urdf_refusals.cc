// One slip in a good URDF each: the complaint names file, line and element.
#include <cmath>

#include "robots/loader/load_robot.h"
#include "tests/support/mutation.h"
#include "tests/support/source_path.h"

namespace limber::test_urdf_refusals {
namespace {

using testing::Mutation;

const double kGravity[3] = {0.0, 0.0, -9.81};

std::string good_urdf() {
  return testing::read_text(source_path("tests/robots/data/arm/robot.urdf"));
}

class UrdfRefusal : public ::testing::TestWithParam<Mutation> {};

TEST_P(UrdfRefusal, NamesPlaceAndProblem) {
  const testing::Mutated bad = testing::apply(good_urdf(), GetParam());
  const testing::TemporaryFolder folder;
  const std::string file = folder.write("robot.urdf", bad.text);
  const std::string complaint =
      testing::complaint_of([&] { load_urdf(file, "base", "hand", kGravity); });
  testing::expect_complaint(complaint, file, bad.line, GetParam().expect);
}

const Mutation kNumbers[] = {
    {"MassWithComma", R"(<mass value="2"/>)", R"(<mass value="1,5"/>)", R"("1,5" is not a finite)"},
    {"MassNan", R"(<mass value="2"/>)", R"(<mass value="nan"/>)", "link 'upper': <mass> value"},
    {"MassInfinite", R"(<mass value="2"/>)", R"(<mass value="inf"/>)", "not a finite number"},
    {"MassTooBigForADouble", R"(<mass value="2"/>)", R"(<mass value="1e999"/>)", "not a finite"},
    {"MassWithUnit", R"(<mass value="2"/>)", R"(<mass value="2kg"/>)", R"("2kg" is not)"},
    {"MassEmpty", R"(<mass value="2"/>)", R"(<mass value=""/>)", R"("" is not a finite number)"},
    {"MassMissing", R"(<mass value="2"/>)", "<mass/>", "<mass> value is missing"},
    {"MassNegative", R"(<mass value="2"/>)", R"(<mass value="-2"/>)", "-2 kg; allowed: 0 to"},
    {"MassInGrams", R"(<mass value="2"/>)", R"(<mass value="20000"/>)", "0 to 10000 kg"},
    {"MassTwice", R"(<mass value="2"/>)", R"(<mass value="2"/><mass value="2"/>)", "here twice"},
    {"MassNotThere", R"(<mass value="2"/>)", "", "<inertial> without <mass>", -2},
    {"InertiaNotThere", R"(<inertia ixx="1e-5" ixy="0" ixz="0" iyy="1e-5" iyz="0" izz="1e-5"/>)",
     "", "<inertial> without <inertia>", -2},
    {"InertiaEntryMissing", R"( iyz="0" izz="0.025")", R"( izz="0.025")",
     "<inertia> iyz is missing"},
    {"InertiaNegative", R"(ixx="0.01")", R"(ixx="-0.01")", "not positive definite"},
    {"InertiaIndefinite", R"(ixy="0.001")", R"(ixy="0.1")", "not positive definite"},
    {"InertiaNan", R"(ixx="0.01")", R"(ixx="nan")", "<inertia> ixx: \"nan\""},
    {"OriginTwoNumbers", R"(xyz="0.2 0 0")", R"(xyz="0.2 0")", "is not 3 finite numbers"},
    {"OriginFourNumbers", R"(xyz="0.2 0 0")", R"(xyz="0.2 0 0 0")", "is not 3 finite numbers"},
    {"OriginWithCommas", R"(xyz="0.2 0 0")", R"(xyz="0.2, 0, 0")", "joint 'slide': <origin> xyz"},
    {"OriginMisspelt", R"(xyz="0.2 0 0")", R"(xzy="0.2 0 0")", "unknown attribute 'xzy'"},
    {"OriginTwice", R"(<origin xyz="0.2 0 0"/>)", R"(<origin/><origin xyz="1 0 0"/>)",
     "here twice"},
    {"QuaternionBesideRpy", R"(rpy="0 0 0.3")", R"(rpy="0 0 0.3" quat_xyzw="0 0 0 1")",
     "rpy is here, too"},
    {"QuaternionOfNoLength", R"(rpy="0 0 0.3")", R"(quat_xyzw="0 0 0 0")", "of length 0 is no"},
    {"QuaternionOfThree", R"(rpy="0 0 0.3")", R"(quat_xyzw="0 0 1")", "is not 4 finite numbers"},
    {"OriginInDegrees", R"(rpy="0 0 0.3")", R"(rpy="0 0 90")", "are these degrees?"},
    {"XacroLeftOver", R"(<mass value="2"/>)", R"(<mass value="${m}"/>)", R"("${m}" is not)"},
};
INSTANTIATE_TEST_SUITE_P(Numbers, UrdfRefusal, ::testing::ValuesIn(kNumbers),
                         testing::MutationName());

const Mutation kJoints[] = {
    {"AxisZero", R"(<axis xyz="1 0 0"/>)", R"(<axis xyz="0 0 0"/>)", "the axis has no length"},
    {"AxisNan", R"(<axis xyz="1 0 0"/>)", R"(<axis xyz="1 nan 0"/>)", "is not 3 finite numbers"},
    {"AxisEmpty", R"(<axis xyz="1 0 0"/>)", "<axis/>", "<axis> xyz is missing"},
    {"LimitReversed", R"(lower="-2" upper="2.5")", R"(lower="2" upper="-2.5")",
     "lower 2 must be below upper -2.5"},
    {"LimitWithoutRoom", R"(lower="-2" upper="2.5")", R"(lower="1" upper="1")",
     "lower 1 must be below upper 1"},
    {"LimitInDegrees", R"(lower="-2" upper="2.5")", R"(lower="-120" upper="150")",
     "are these degrees?"},
    {"LimitNan", R"(upper="2.5")", R"(upper="nan")", "<limit> upper"},
    {"LimitMisspelt", R"(upper="2.5")", R"(uper="2.5")", "unknown attribute 'uper'"},
    {"EffortNegative", R"(effort="4")", R"(effort="-4")", "effort: -4 must be above 0"},
    {"DampingNotANumber", R"(damping="0.1")", R"(damping="some")", R"(damping: "some")"},
    {"TypeUnknown", R"(type="revolute")", R"(type="hinge")", "type 'hinge'; expected one of"},
    {"TypeMissing", R"( type="revolute")", "", "type ''; expected one of"},
    {"TypeFloating", R"(type="continuous")", R"(type="floating")", "cannot be part of an arm"},
    {"TypePlanar", R"(type="continuous")", R"(type="planar")", "cannot be part of an arm"},
    {"ParentMissing", R"(<parent link="upper"/>)", "", "<parent link=\"...\"/> is missing", -1},
    {"ChildMissing", R"(<child link="fore"/>)", "", "<child link=\"...\"/> is missing", -2},
    {"ParentUnknown", R"(<parent link="upper"/>)", R"(<parent link="uper"/>)",
     "parent link 'uper' does not exist; did you mean 'upper'?", -1},
    {"ChildUnknown", R"(<child link="fore"/>)", R"(<child link="nothing"/>)",
     "child link 'nothing' does not exist", -2},
    {"DynamicsMisspelt", "<dynamics damping=", "<dynamics dampng=", "unknown attribute 'dampng'"},
    {"ElementMisspelt", "<dynamics ", "<dynamcs ", "did you mean <dynamics>?"},
};
INSTANTIATE_TEST_SUITE_P(Joints, UrdfRefusal, ::testing::ValuesIn(kJoints),
                         testing::MutationName());

const Mutation kTree[] = {
    {"LinkTwice", R"(<link name="fore">)", R"(<link name="upper">)",
     "the name 'upper' is taken by"},
    {"JointTwice", R"(<joint name="slide")", R"(<joint name="turn")",
     "the name 'turn' is taken by"},
    {"LinkWithoutName", R"(<link name="fore">)", "<link>", "<link>: has no name"},
    {"JointWithoutName", R"( name="slide")", "", "<joint>: has no name"},
    {"TwoParents", R"(<child link="hand"/>)", R"(<child link="fore"/>)",
     "link 'fore' already hangs from joint 'slide'", -2},
    {"TwoRoots", R"(<link name="world"/>)", R"(<link name="world"/><link name="moon"/>)",
     "several roots, expected one tree: moon, world", testing::kNoLine},
    {"NotXml", "</robot>", "</robott>", "not well-formed XML", testing::kNoLine},
    {"CutOff", "<limit effort", "<limit effort=\"", "not well-formed XML", testing::kNoLine},
    {"TagsThatDoNotMatch", "<robot name=\"arm\">", "<sdf name=\"arm\">", "not well-formed",
     testing::kNoLine},
    {"Doctype", "<robot", "<!DOCTYPE r [<!ENTITY a \"b\">]>\n<robot", "entities (<!...>) are not"},
    {"Xacro", R"(<link name="base"/>)", R"(<xacro:arm_macro name="base"/>)", "expand them first"},
    {"BareAmpersand", R"(<joint name="slide")", R"(<joint name="sl&ide")", "'&' begins none of"},
    {"CharacterByNumber", R"(<joint name="slide")", R"(<joint name="sl&#105;de")", "'&' begins"},
    {"ZeroByte", R"(<link name="base"/>)", std::string("<link\0/>", 8), "zero byte"},
};
INSTANTIATE_TEST_SUITE_P(Tree, UrdfRefusal, ::testing::ValuesIn(kTree), testing::MutationName());

std::string refusal(const std::string& text, const std::string& base = "base",
                    const std::string& tip = "hand") {
  const testing::TemporaryFolder folder;
  const std::string file = folder.write("robot.urdf", text);
  return testing::complaint_of([&] { load_urdf(file, base, tip, kGravity); });
}

std::string robot_of(const std::string& body) { return "<robot name=\"r\">" + body + "</robot>"; }

std::string fixed_joint(const std::string& name, const std::string& parent,
                        const std::string& child) {
  return "<joint name=\"" + name + "\" type=\"fixed\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/></joint>\n";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(UrdfRefusals, TheFileTheyChangeIsAccepted) {
  const testing::TemporaryFolder folder;
  const std::string file = folder.write("robot.urdf", good_urdf());
  EXPECT_EQ(load_urdf(file, "base", "hand", kGravity).robot.size(), 3);
}

TEST(UrdfRefusals, TellEverythingThatIsWrong) {
  std::string text = good_urdf();
  for (const Mutation& mutation : {Mutation{"", R"(value="2")", R"(value="1,5")", ""},
                                   Mutation{"", R"(rpy="0 0 0.3")", R"(rpy="0 0 30")", ""},
                                   Mutation{"", R"(effort="20")", R"(effort="")", ""}}) {
    text = testing::apply(text, mutation).text;
  }
  const std::string complaint = refusal(text);
  EXPECT_EQ(std::count(complaint.begin(), complaint.end(), '\n'), 2) << complaint;
  for (const char* line : {":8: joint 'stand'", ":16: joint 'turn'", ":22: link 'upper'"})
    EXPECT_TRUE(contains(complaint, line)) << complaint;
}

TEST(UrdfRefusals, StopAfterFiftyComplaints) {
  std::string links;
  for (int i = 0; i < 200; ++i) links += "<link/>";
  const std::string complaint = refusal(robot_of(links));
  EXPECT_EQ(std::count(complaint.begin(), complaint.end(), '\n'), 50);
  EXPECT_TRUE(contains(complaint, "and more"));
}

TEST(UrdfRefusals, Loops) {
  const std::string ring = R"(<link name="a"/><link name="b"/>)" + fixed_joint("j1", "a", "b") +
                           fixed_joint("j2", "b", "a");
  EXPECT_TRUE(contains(refusal(robot_of(ring)), "no root"));
  EXPECT_TRUE(contains(refusal(robot_of("<link name=\"c\"/>" + ring)), "they form a loop: a, b"));
  const std::string itself = "<link name=\"a\"/>" + fixed_joint("j", "a", "a");
  EXPECT_TRUE(contains(refusal(robot_of(itself)), "no root"));
}

TEST(UrdfRefusals, BaseAndTip) {
  const std::string unknown = refusal(good_urdf(), "base", "hnad");
  EXPECT_TRUE(contains(unknown, "tip: no link 'hnad'; did you mean 'hand'?")) << unknown;
  EXPECT_TRUE(contains(unknown, "there are: base, finger, fore, hand, upper, world")) << unknown;
  EXPECT_TRUE(contains(refusal(good_urdf(), "nowhere", "hand"), "base: no link 'nowhere'"));
  EXPECT_TRUE(
      contains(refusal(good_urdf(), "hand", "base"), "'base' does not lie below the base 'hand'"));
  EXPECT_TRUE(contains(refusal(good_urdf(), "world", "base"), "no moving joint between"));
  EXPECT_TRUE(contains(refusal(good_urdf(), "hand", "hand"), "no moving joint between"));
}

TEST(UrdfRefusals, GravityOfAnotherPlanet) {
  const std::string file = source_path("tests/robots/data/arm/robot.urdf");
  for (const double g : {-981.0, std::nan(""), HUGE_VAL}) {
    const double gravity[3] = {0.0, 0.0, g};
    EXPECT_TRUE(contains(testing::complaint_of([&] { load_urdf(file, "base", "hand", gravity); }),
                         "gravity"));
  }
}

TEST(UrdfRefusals, FilesThatAreTooMuch) {
  EXPECT_TRUE(contains(refusal(std::string((8 << 20) + 1, ' ')), "larger than 8 MiB"));
  std::string links;
  for (int i = 0; i < 100'000; ++i) links += "<link name=\"l" + std::to_string(i) + "\"/>\n";
  EXPECT_TRUE(contains(refusal(robot_of(links)), "more than 10000 elements"));
  std::string deep;
  for (int i = 0; i < 5'000; ++i) deep += "<a>";
  EXPECT_TRUE(contains(refusal(robot_of(deep)), "not well-formed XML"));
}

// What another XML parser would refuse is refused here, with its line.
TEST(UrdfRefusals, FilesThatAreNotWellFormed) {
  const std::string good = good_urdf();
  const auto with = [&](const std::string& line) {
    const std::size_t at = good.find("<link name=\"base\"/>");
    return good.substr(0, at) + line + good.substr(at);
  };
  EXPECT_TRUE(contains(refusal(with("<!-- made from arm--v2 -->")), "two dashes are not allowed"));
  EXPECT_TRUE(contains(refusal(with("<a b='1' b='2'/>")), "duplicate attribute"));
  EXPECT_TRUE(contains(refusal(with("<a b='x < y'/>")), "not well-formed"));
  EXPECT_TRUE(contains(refusal(with("<!-- Gr\xfc\xdf"
                                    "e -->")),
                       "is the file UTF-8?"));
  EXPECT_TRUE(contains(refusal(good + "<robot/>"), "junk after document element"));
}

TEST(UrdfRefusals, OtherEncodings) {
  std::string body = good_urdf();
  body.erase(0, body.find("<robot"));
  const std::string head = "<?xml version=\"1.0\" encoding=\"gb2312\"?>\n";
  const testing::TemporaryFolder folder;
  const std::string ascii = folder.write("robot.urdf", head + body);
  EXPECT_EQ(load_urdf(ascii, "base", "hand", kGravity).robot.size(), 3);
  const std::string refused = refusal(head + "<!-- \xbb\xfa\xd0\xb5 -->" + body);
  EXPECT_TRUE(contains(refused, "robot.urdf:2: characters in the encoding 'gb2312'")) << refused;
  EXPECT_TRUE(contains(refused, "iconv -f gb2312 -t UTF-8")) << refused;
  const std::string utf8 = folder.write("utf8.urdf", "<!-- Grüße 机械 -->" + body);
  EXPECT_EQ(load_urdf(utf8, "base", "hand", kGravity).robot.size(), 3);
}

TEST(UrdfRefusals, NamesThatCannotBeShown) {
  for (const std::string& name : {std::string(129, 'x'), std::string("a\x01")}) {
    std::string text = good_urdf();
    text.replace(text.find("\"slide\""), 7, "\"" + name + "\"");
    EXPECT_TRUE(contains(refusal(text), name.size() > 100 ? "is no name" : "not well-formed"));
  }
  EXPECT_TRUE(contains(
      refusal(testing::apply(good_urdf(), {"", R"(name="slide")", "name=\"a\x7f\"", ""}).text),
      "'a?' is no name"));
}

TEST(UrdfRefusals, FilesThatAreNoUrdf) {
  EXPECT_TRUE(contains(refusal(""), "robot.urdf"));
  EXPECT_TRUE(contains(refusal(std::string(1000, '\xff')), "robot.urdf"));
  EXPECT_TRUE(contains(refusal("<sdf/>"), "not a URDF"));
  EXPECT_TRUE(contains(refusal("<robot/>"), "no <link> at all"));
  std::string future = good_urdf();
  future.replace(future.find("<robot name=\"arm\">"), 18, "<robot name='arm' version='banana'>");
  EXPECT_TRUE(contains(refusal(future), "version \"banana\"; limber reads URDF 1.0, 1.1 and 1.2"));
}

TEST(UrdfRefusals, NoSuchFile) {
  for (const char* file : {"/nowhere/robot.urdf", "/", ""}) {
    EXPECT_TRUE(contains(testing::complaint_of([&] { load_urdf(file, "base", "hand", kGravity); }),
                         "no such file"));
  }
}

TEST(UrdfRefusals, MoreThanSixteenJoints) {
  std::string body = "<link name=\"base\"/>";
  for (int i = 0; i < 17; ++i) {
    const std::string number = std::to_string(i);
    const std::string parent = i == 0 ? "base" : "l" + std::to_string(i - 1);
    body += "<joint name=\"j" + number + "\" type=\"continuous\"><parent link=\"" + parent +
            "\"/><child link=\"l" + number + "\"/></joint><link name=\"l" + number + "\"/>";
  }
  EXPECT_TRUE(contains(refusal(robot_of(body), "base", "l16"), "17 moving joints"));
}

TEST(UrdfRefusals, JointsThatMoveNoMass) {
  std::string text = good_urdf();
  const auto finger = text.find("<joint name=\"finger_joint\"");
  const auto mass = text.find("<inertial>", text.find("<link name=\"hand\">"));
  const auto end = text.find("</inertial>", mass) + 11;
  text = text.substr(0, mass) + text.substr(end, finger - end) + "</robot>";
  const std::string complaint = refusal(text);
  EXPECT_TRUE(contains(complaint, "joint 'roll': moves no mass")) << complaint;
}

}  // namespace
}  // namespace limber::test_urdf_refusals
