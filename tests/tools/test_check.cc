// The program limber-check as a user meets it: what it prints, and exit status 2 for everything
// that is not right.
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "tests/support/mutation.h"
#include "tests/support/source_path.h"

namespace limber::test_check {
namespace {

const std::string kArm = source_path("tests/robots/data/arm");
const std::string kUrdf = kArm + "/robot.urdf";
const std::string kScenario = source_path("tests/scenarios/data/good.yaml");

struct Outcome {
  int status = -1;  ///< exit status; 1000 + signal if it crashed
  std::string output;
};

/// Arguments as in a shell; errors and output together, or output alone.
Outcome check(const std::string& arguments, bool with_errors = true) {
  const std::string command =
      std::string(LIMBER_CHECK) + " " + arguments + (with_errors ? " 2>&1" : " 2>/dev/null");
  std::FILE* pipe = ::popen(command.c_str(), "r");
  Outcome outcome;
  char part[4096];
  for (std::size_t size; (size = std::fread(part, 1, sizeof part, pipe)) > 0;)
    outcome.output.append(part, size);
  const int status = ::pclose(pipe);
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  return outcome;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Check, AResultThatCannotBeWrittenIsAnError) {
  EXPECT_EQ(check("robot openarm >/dev/full").status, 3);
  EXPECT_EQ(check("--help >/dev/full").status, 3);
  EXPECT_EQ(check("robot openarm | true").status, 0);
}

/// A scenario of a shipped robot with these lines.
std::string scenario_of(const testing::TemporaryFolder& folder, const std::string& robot,
                        const std::string& lines) {
  return folder.write("s.yaml", "format: limber-scenario/1\nrobot: " + robot +
                                    "\nmode: lockstep\nduration_s: 3\n" + lines);
}

// desktop2r's joints end at 2.6 rad; its soft walls are 0.1 rad wide.
TEST(Check, NotesAStartInASoftWallOrAtItsEdge) {
  const testing::TemporaryFolder folder;
  const auto notes = [&](const std::string& pose) {
    return check("scenario " + scenario_of(folder, "desktop2r", "start_q: " + pose + "\n")).output;
  };
  EXPECT_TRUE(
      contains(notes("[2.55, 0]"), "start: shoulder at 2.55, 0.05 rad from its end at 2.6"));
  EXPECT_TRUE(contains(notes("[2.55, 0]"), "in its soft wall, which pushes with"));
  EXPECT_TRUE(contains(notes("[0, -2.499]"), "elbow at -2.499, 0.101 rad from its end at -2.6"));
  EXPECT_TRUE(contains(notes("[0, -2.499]"), "at the edge of its soft wall"));
  EXPECT_FALSE(contains(notes("[2.4, -2.4]"), "soft wall"));
}

TEST(Check, TellsWhichWayAContinuousJointTurns) {
  const testing::TemporaryFolder folder;
  std::string urdf = testing::read_text(source_path("robots/desktop2r/robot.urdf"));
  const std::string type = "type=\"revolute\"";
  for (std::size_t at; (at = urdf.find(type)) != std::string::npos;)
    urdf.replace(at, type.size(), "type=\"continuous\"");
  std::string yaml = testing::read_text(source_path("robots/desktop2r/robot.yaml"));
  for (const char* home : {"    home_rad: -1.2", "    home_rad: 1.4"})
    yaml.replace(yaml.find(home), 4, "    position_min_rad: -6\n    position_max_rad: 6\n    ");
  folder.write("robot.urdf", urdf);
  folder.write("robot.yaml", yaml);
  const std::string file =
      scenario_of(folder, ".",
                  "start_q: [3, 0]\ntimeline:\n"
                  "  - {at_s: 1, goal: {joints_rad: [-3, 0.5], duration_s: 1}}\n");
  const std::string output = check("scenario " + file).output;
  EXPECT_TRUE(contains(output, "turns by -6 rad, from 3 to -3")) << output;
  EXPECT_TRUE(contains(output, "is reached by +0.2832 rad: 3.283")) << output;
  EXPECT_EQ(output.find("elbow turns"), std::string::npos);
}

TEST(Check, TellsOfAShippedRobot) {
  const Outcome outcome = check("robot openarm");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_TRUE(contains(outcome.output, "7 joints from world to link8, 4.375 kg moving"));
  EXPECT_TRUE(contains(outcome.output, "dm_j8009p_2ec, arm, 0x01/0x11"));
  // 14 FD frames of 8 bytes at 56.6 us make 792 us of each millisecond, a setting's request and
  // answer every 20 cycles 5.7 us more.
  EXPECT_TRUE(
      contains(outcome.output,
               "72.7 % busy at 1000 Hz (at most 79.8 %), last reply after 0.85 ms of 0.90 ms"))
      << outcome.output;
}

TEST(Check, TellsOfSpringsSensorsAndLoops) {
  const Outcome outcome = check("robot " + source_path("tests/robots/data/chain"));
  EXPECT_EQ(outcome.status, 0);
  EXPECT_TRUE(contains(outcome.output, "4000 d + 900 d^3")) << outcome.output;
  EXPECT_TRUE(contains(outcome.output, "400 d^2/2"));
  EXPECT_TRUE(contains(outcome.output, "B/4 at 4000 Hz"));
  EXPECT_TRUE(contains(outcome.output, "motor 22 bit, link 20 bit, torque"));
  // Late by 125 + 100 + 500 + 300 us: 5.125 N m s/rad, less the damper's 2; there to pay: 3 + 2.
  EXPECT_TRUE(contains(outcome.output, "inertia_ratio 4 is expected to be unstable; below 2.6"));
}

TEST(Check, RigidArmHasNoTableOfSprings) {
  EXPECT_FALSE(contains(check("robot openarm").output, "transmission"));
}

TEST(Check, FindsRobotsByFolderAndByEnvironment) {
  EXPECT_EQ(check("robot " + kArm).status, 0);
  EXPECT_EQ(check("robot " + kArm + "/").status, 0);
  ::setenv("LIMBER_ROBOTS", source_path("tests/robots/data").c_str(), 1);
  EXPECT_EQ(check("robot arm").status, 0);
  EXPECT_TRUE(contains(check("robot openarm").output, "one of: arm"));
  ::unsetenv("LIMBER_ROBOTS");
}

TEST(Check, WarnsWhereGravityIsTooMuch) {
  const Outcome outcome = check("robot desktop2r");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_TRUE(contains(outcome.output, "warning: shoulder: gravity needs up to 7.01"));
}

TEST(Check, WarnsOfARateLimitThatLimitsNothing) {
  // 3500 N m/s are half of 7 N m in a cycle at 1 kHz.
  for (const auto& [rate, can, warned] : {std::tuple{"3600", "socketcan:can0", true},
                                          {"3400", "socketcan:can0", false},
                                          {"3600", "virtual:desktop2r", false}}) {
    const testing::TemporaryFolder folder;
    const std::string robot = source_path("robots/desktop2r/");
    folder.write("robot.urdf", testing::read_text(robot + "robot.urdf"));
    std::string yaml = testing::read_text(robot + "robot.yaml");
    yaml = testing::apply(yaml, {"", "virtual:desktop2r", can, ""}).text;
    yaml =
        testing::apply(
            yaml, {"", "    bus: arm\n",
                   std::string("    bus: arm\n    torque_rate_limit_Nm_per_s: ") + rate + "\n", ""})
            .text;
    folder.write("robot.yaml", yaml);
    const Outcome outcome = check("robot " + folder.path());
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_EQ(contains(outcome.output, "the gate will pass almost any step"), warned)
        << rate << can << outcome.output;
  }
}

TEST(Check, RefusesABusThatCannotCarryTheArm) {
  // Seven joints on a classic bus at 1 kHz: 14 frames of 135 bits are 189 % of 1 Mbit/s, two more
  // every 20 cycles, for a setting, 1.35 %.
  const testing::TemporaryFolder folder;
  const std::string openarm = source_path("robots/openarm/");
  folder.write("robot.urdf", testing::read_text(openarm + "robot.urdf"));
  folder.write("robot.yaml",
               testing::apply(testing::read_text(openarm + "robot.yaml"),
                              {"", "fd: true, bitrate_bps: 1000000, data_bitrate_bps: 5000000",
                               "bitrate_bps: 1000000", ""})
                   .text);
  const Outcome outcome = check("robot " + folder.path());
  EXPECT_EQ(outcome.status, 2);
  EXPECT_TRUE(
      contains(outcome.output,
               "at 1000 Hz the last reply may come 1.95 ms after the start of a cycle (load 190 %"))
      << outcome.output;
  EXPECT_TRUE(contains(outcome.output, "the highest rate is 461 Hz")) << outcome.output;
}

TEST(Check, TellsOfABareUrdfUnderAnyGravity) {
  const Outcome down = check("urdf " + kUrdf + " --base world --tip hand");
  EXPECT_EQ(down.status, 0);
  EXPECT_TRUE(contains(
      down.output, "robot.urdf:57: joint: not part of the arm, frozen at zero: 'finger_joint'"));
  const Outcome sideways = check("urdf " + kUrdf + " --base world --tip hand --gravity -1.6,0,0");
  EXPECT_EQ(sideways.status, 0);
  EXPECT_TRUE(contains(sideways.output, "gravity [-1.6, 0, 0] m/s^2")) << sideways.output;
}

TEST(Check, ChoosesTheEndsOfTheOnlyArm) {
  for (const char* ends : {"", " --base world", " --tip hand"}) {
    const Outcome outcome = check("urdf " + kUrdf + ends);
    EXPECT_EQ(outcome.status, 0);
    EXPECT_TRUE(contains(outcome.output, "3 joints from world to hand")) << outcome.output;
  }
}

TEST(Check, ListsTheArmsOfAUrdf) {
  const testing::TemporaryFolder folder;
  const std::string sister =
      "<link name='eye'/><joint name='neck' type='revolute'><parent link='world'/>"
      "<child link='eye'/></joint></robot>";
  const std::string file = folder.write(
      "two.urdf", testing::apply(testing::read_text(kUrdf), {"", "</robot>", sister, ""}).text);
  const Outcome outcome = check("urdf " + file);
  EXPECT_EQ(outcome.status, 2);
  for (const std::string& part :
       {std::string("3  turn, slide, roll\n          --base world --tip hand"),
        std::string("1  neck\n          --base world --tip eye"),
        file + ": which arm? give --base LINK and --tip LINK"}) {
    EXPECT_TRUE(contains(outcome.output, part)) << outcome.output;
  }
  const Outcome listed = check("urdf " + file + " --json", false);
  EXPECT_EQ(listed.status, 2);
  EXPECT_TRUE(contains(listed.output,
                       R"("chains": [{"base": "world", "tip": "hand", "also": [], "joints": )"))
      << listed.output;
}

TEST(Check, TellsWhichRobotAScenarioMeans) {
  const testing::TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() + "/openarm");
  for (const char* file : {"/robot.yaml", "/robot.urdf"})
    folder.write(std::string("openarm") + file, testing::read_text(kArm + file));
  const std::string scenario =
      folder.write("first.yaml", "format: limber-scenario/1\nrobot: openarm\nduration_s: 1\n");
  const Outcome outcome = check("scenario " + scenario);
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_TRUE(contains(outcome.output, "first: arm, 1 s"));
  EXPECT_TRUE(contains(outcome.output,
                       scenario + ":2: robot: 'openarm' is the folder beside this file, not the "
                                  "shipped robot"))
      << outcome.output;
}

TEST(Check, TellsOfAScenario) {
  const Outcome outcome = check("scenario " + kScenario);
  EXPECT_EQ(outcome.status, 0);
  EXPECT_TRUE(
      contains(outcome.output, "good: arm, 12 s, realtime, reference integrator at 0.5 ms"));
  EXPECT_TRUE(contains(outcome.output, "push 3 at fore: [1, 2, 3] N [0.1, 0, 0] N m for 0.5 s"));
}

TEST(Check, RefusesALawThatDoesNotExist) {
  const testing::TemporaryFolder folder;
  const std::string file =
      folder.write("s.yaml",
                   "format: limber-scenario/1\nrobot: openarm\nduration_s: 2\ntimeline:\n"
                   "  - {at_s: 1.5, gains: {law: cartesian_impedence}}\n");
  const Outcome outcome = check("scenario " + file);
  EXPECT_EQ(outcome.status, 2);
  EXPECT_TRUE(contains(outcome.output,
                       "s.yaml:5: timeline[0].gains.law: found 'cartesian_impedence'; expected one "
                       "of: gravity_compensation, joint_pd,"))
      << outcome.output;
}

TEST(Check, TellsOfATipSensor) {
  const testing::TemporaryFolder folder;
  folder.write("robot.urdf", testing::read_text(kUrdf));
  folder.write("robot.yaml", testing::read_text(kArm + "/robot.yaml") +
                                 testing::read_text(kArm + "/../tip_sensor.yaml"));
  EXPECT_TRUE(
      contains(check("robot " + folder.path()).output, "tip sensor: FT-1 on right, id 100"));
  EXPECT_TRUE(contains(check("robot " + folder.path() + " --json").output,
                       "\"tip_sensor\": {\"model\": \"FT-1\", \"bus\": \"right\", \"id\": 100, "
                       "\"reply_ids\": [5, 6], \"range_N_Nm\": [200, 200, 300, 10, 10, 10]"));
  EXPECT_TRUE(contains(check("robot " + kArm + " --json").output, "\"tip_sensor\": null"));
}

std::string gains_scenario(const std::string& gains, const std::string& robot = "openarm") {
  return "format: limber-scenario/1\nrobot: " + robot +
         "\nduration_s: 2\ntimeline:\n"
         "  - {at_s: 0.5, gains: {" +
         gains + "}}\n";
}

TEST(Check, SaysHowStiffTheGainsAre) {
  const testing::TemporaryFolder folder;
  const auto outcome_of = [&](const std::string& gains) {
    return check("scenario " + folder.write("s.yaml", gains_scenario(gains)));
  };
  const Outcome soft = outcome_of("K_x_translation_N_per_m: 300");
  EXPECT_EQ(soft.status, 0);
  EXPECT_TRUE(contains(soft.output, "% of the stiffest: ok")) << soft.output;
  EXPECT_FALSE(contains(soft.output, "warning")) << soft.output;
  const Outcome stiff = outcome_of("K_x_translation_N_per_m: 100000, damping_ratio: 0.05");
  EXPECT_EQ(stiff.status, 0) << "a warning is no error";
  EXPECT_TRUE(contains(stiff.output, "warning: gains at 0.5 s: K_x is")) << stiff.output;
  const Outcome undamped = outcome_of("damping_ratio: 0");
  EXPECT_TRUE(contains(undamped.output, "K_x is unstable with this damping, however soft"))
      << undamped.output;
}

// tomei's bound is a law's own: the file reader does not know it.
TEST(Check, WarnsOfGainsThatALawRefuses) {
  const testing::TemporaryFolder folder;
  const std::string file =
      folder.write("s.yaml",
                   "format: limber-scenario/1\nrobot: iiwa14\nduration_s: 3\ntimeline:\n"
                   "  - {at_s: 1.0, gains: {law: tomei, K_q_Nm_per_rad: 300}}\n"
                   "  - {at_s: 2.0, gains: {law: tomei, K_q_Nm_per_rad: 5}}\n");
  const Outcome outcome = check("scenario " + file);
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_FALSE(contains(outcome.output, "gains at 1 s will be refused")) << outcome.output;
  EXPECT_TRUE(contains(outcome.output,
                       "warning: gains at 2 s will be refused: request.LAW: K_q is too soft"))
      << outcome.output;
}

// The whole timeline goes through the controller's own checks, in its order and at its times.
TEST(Check, ForetellsEveryRequestThatIsRefused) {
  struct Case {
    const char* name;
    std::string timeline;
    std::string expect;  // "": nothing is refused
  };
  const std::string start = "  - {at_s: 0.3, mode: hold}\n  - {at_s: 0.8, mode: active}\n";
  const std::string offset = "goal: {offset_m: [0.05, 0, 0], duration_s: 1}}\n";
  const std::string soft = "  - {at_s: 0.9, gains: {law: joint_pd}}\n";
  const std::string joints = "goal: {joints_rad: [0.4, 1.0], duration_s: 1}}\n";
  const Case cases[] = {
      {"a joint goal under the default law", start + "  - {at_s: 1.0, " + joints,
       "goal at 1 s will be refused: request.GOAL_KIND"},
      {"under a law that follows it", start + soft + "  - {at_s: 1.0, " + joints, ""},
      {"a goal before ACTIVE", "  - {at_s: 0.3, mode: hold}\n  - {at_s: 0.5, " + offset,
       "goal at 0.5 s will be refused: request.MODE"},
      {"active without hold", "  - {at_s: 0.3, mode: idle}\n  - {at_s: 0.8, mode: active}\n",
       "mode at 0.8 s will be refused: request.MODE"},
      {"nothing wrong", start + "  - {at_s: 1.0, " + offset + "  - {at_s: 3.0, mode: stop}\n", ""},
      {"a goal while it stops", start + "  - {at_s: 1.0, mode: stop}\n  - {at_s: 1.1, " + offset,
       "goal at 1.1 s will be refused: request.MODE"},
      {"after an injected fault nobody knows",
       start + "  - {at_s: 1.0, fault: {joint: shoulder, kind: drive_error}}\n  - {at_s: 1.5, " +
           joints,
       ""},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    const testing::TemporaryFolder folder;
    const Outcome outcome = check(
        "scenario " +
        folder.write(
            "s.yaml",
            "format: limber-scenario/1\nrobot: planar2r\nduration_s: 5\ntimeline:\n" + c.timeline));
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_EQ(contains(outcome.output, "refused"), !c.expect.empty()) << outcome.output;
    EXPECT_TRUE(contains(outcome.output, c.expect)) << outcome.output;
  }
}

TEST(Check, NoShippedScenarioIsRefused) {
  for (const auto& file : std::filesystem::directory_iterator(source_path("scenarios"))) {
    if (file.path().extension() != ".yaml") continue;
    const Outcome outcome = check("scenario " + file.path().string());
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_FALSE(contains(outcome.output, "refused")) << outcome.output;
  }
}

// planar2r: two uniform rods, l = (0.5, 0.4) m, m = (4, 2.5) kg, elbow at 1 rad. The joint modes
// solve det(K - w^2 M) = 0.
TEST(Check, ModesAreThoseOfTheClosedForm) {
  const double coupling = 2.5 * 0.5 * 0.2 * std::cos(1.0);
  const double M22 = 0.4 * 0.4 * 2.5 / 3.0;
  const double M11 = 4.0 * 0.25 / 3.0 + 2.5 * 0.25 + M22 + 2.0 * coupling;
  const double M12 = M22 + coupling;
  const double K1 = 300.0;
  const double K2 = 200.0;
  const double a = M11 * M22 - M12 * M12;
  const double b = K1 * M22 + K2 * M11;
  const double w2 = (b + std::sqrt(b * b - 4.0 * a * K1 * K2)) / (2.0 * a);
  // A damping ratio of 1: (1 / tau^2) x^2 cos x with cos x = sqrt(5) - 2, tau = 1.5 ms.
  const double x = std::acos(std::sqrt(5.0) - 2.0);
  const double share = w2 / (x * x * std::cos(x)) * 1.5e-3 * 1.5e-3;
  char expected[100];
  std::snprintf(expected, sizeof expected, "joints up to %.0f rad/s, %.2g %% of the stiffest: ok",
                std::sqrt(w2), 100.0 * share);
  const testing::TemporaryFolder folder;
  const std::string gains = "K_q_Nm_per_rad: [300, 200], joint_damping_ratio: 1";
  const Outcome outcome =
      check("scenario " + folder.write("s.yaml", gains_scenario(gains, "planar2r")));
  EXPECT_EQ(outcome.status, 0);
  EXPECT_TRUE(contains(outcome.output, expected)) << expected << "\n" << outcome.output;
}

TEST(Check, SpeaksJson) {
  for (const std::string& arguments :
       {std::string("robot openarm"), "urdf " + kUrdf + " --base world --tip hand",
        "scenario " + kScenario}) {
    const Outcome outcome = check(arguments + " --json");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.output.rfind("{\"ok\": true, ", 0), 0u) << outcome.output;
    EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1);
    EXPECT_FALSE(contains(outcome.output, "inf"));
    EXPECT_FALSE(contains(outcome.output, "nan"));
  }
  const Outcome refused = check("robot nobody --json", false);
  EXPECT_EQ(refused.status, 2);
  EXPECT_EQ(refused.output.rfind("{\"ok\": false, \"complaints\": [\"no robot 'nobody'", 0), 0u)
      << refused.output;
}

TEST(Check, ReportsEachComplaintOnALineOfItsOwn) {
  std::string text = testing::read_text(kUrdf);
  text = testing::apply(text, {"", "value=\"2\"", "value=\"1,5\"", ""}).text;
  text = testing::apply(text, {"", "effort=\"20\"", "effort=\"inf\"", ""}).text;
  const testing::TemporaryFolder folder;
  const std::string file = folder.write("robot.urdf", text);
  const Outcome outcome = check("urdf " + file + " --base world --tip hand");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.output,
            file + ":16: joint 'turn': <limit> effort: \"inf\" is not a finite number\n" + file +
                ":22: link 'upper': <mass> value: \"1,5\" is not a finite number\n");
}

struct CommandLine {
  const char* name;
  std::string arguments;
  std::string expect;
};

std::ostream& operator<<(std::ostream& out, const CommandLine& line) {
  return out << line.arguments;
}

class CheckRefusal : public ::testing::TestWithParam<CommandLine> {};

TEST_P(CheckRefusal, ExitsWithTwoAndSaysWhatWouldBeRight) {
  const Outcome outcome = check(GetParam().arguments);
  EXPECT_EQ(outcome.status, 2);
  EXPECT_TRUE(contains(outcome.output, GetParam().expect)) << outcome.output;
}

const std::string kBareUrdf = "urdf " + kUrdf + " ";
const CommandLine kCommandLines[] = {
    {"Nothing", "", "subcommand is required"},
    {"UnknownSubcommand", "robots openarm", "subcommand is required"},
    {"RobotWithoutName", "robot", "robot is required"},
    {"RobotEmptyName", "robot ''", "no robot ''"},
    {"RobotUnknown", "robot openarn", "did you mean 'openarm'?"},
    {"RobotIsAFile", "robot " + kUrdf, "expected a folder with robot.yaml"},
    {"TwoRobots", "robot openarm desktop2r", "not expected"},
    {"UnknownOption", "robot openarm --fast", "not expected: --fast"},
    {"UrdfUnknownBase", kBareUrdf + "--base wordl --tip hand", "did you mean 'world'?"},
    {"UrdfUnknownTip", kBareUrdf + "--base world --tip foot", "there are: base, finger, fore"},
    {"UrdfNoSuchFile", "urdf nothing.urdf --base a --tip b", "nothing.urdf: no such file"},
    {"UrdfIsYaml", "urdf " + kScenario + " --base a --tip b", "good.yaml"},
    {"GravityTwoNumbers", kBareUrdf + "--base world --tip hand --gravity 0,9.81", "expected three"},
    {"GravityFourNumbers", kBareUrdf + "--base world --tip hand --gravity 0,0,0,1",
     "expected three"},
    {"GravityText", kBareUrdf + "--base world --tip hand --gravity down", "expected three numbers"},
    {"GravityNan", kBareUrdf + "--base world --tip hand --gravity 0,0,nan", "expected three"},
    {"GravityHuge", kBareUrdf + "--base world --tip hand --gravity 0,0,-981", "out of range"},
    {"GravityTrailingComma", kBareUrdf + "--base world --tip hand --gravity 0,0,1,",
     "expected three"},
    {"ScenarioNoSuchFile", "scenario nothing.yaml", "nothing.yaml: no such file"},
    {"ScenarioIsAFolder", "scenario /tmp", "/tmp: no such file"},
    {"ScenarioIsARobot", "scenario " + kArm + "/robot.yaml", "limber-scenario/1"},
};
INSTANTIATE_TEST_SUITE_P(CommandLines, CheckRefusal, ::testing::ValuesIn(kCommandLines),
                         [](const auto& line) { return line.param.name; });

}  // namespace
}  // namespace limber::test_check
