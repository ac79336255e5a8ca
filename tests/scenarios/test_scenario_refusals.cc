// One slip in a good scenario each: the complaint names file, line and key.
#include "controller/laws/registry.h"
#include "scenarios/loader/scenario.h"
#include "tests/support/mutation.h"
#include "tests/support/source_path.h"

namespace limber::test_scenario_refusals {
namespace {

using testing::Mutation;

std::string good_scenario() {
  return testing::read_text(source_path("tests/scenarios/data/good.yaml"));
}

const LoadedRobot& arm() {
  static const LoadedRobot robot = load_robot(source_path("tests/robots/data/arm"));
  return robot;
}

std::string refusal(const std::string& text, std::string* file) {
  const testing::TemporaryFolder folder;
  *file = folder.write("s.yaml", text);
  return testing::complaint_of([&] { load_scenario(*file, arm(), &controller::law_catalog()); });
}

class ScenarioRefusal : public ::testing::TestWithParam<Mutation> {};

TEST_P(ScenarioRefusal, NamesPlaceAndProblem) {
  const testing::Mutated bad = testing::apply(good_scenario(), GetParam());
  std::string file;
  const std::string complaint = refusal(bad.text, &file);
  testing::expect_complaint(complaint, file, bad.line, GetParam().expect);
}

const Mutation kHead[] = {
    {"Format", "limber-scenario/1", "limber-robot/1", "expected one of: limber-scenario/1"},
    {"FormatMissing", "format: limber-scenario/1\n", "", "'format' is missing"},
    {"UnknownKey", "seed: 5", "sead: 5", "unknown key 'sead'; did you mean 'seed'?"},
    {"RobotMissing", "robot: ../../robots/data/arm\n", "", "'robot' is missing", testing::kNoLine},
    {"Mode", "mode: realtime", "mode: fast", "expected one of: lockstep, realtime"},
    {"DurationMissing", "duration_s: 12\n", "", "'duration_s' is missing", testing::kNoLine},
    {"DurationZero", "duration_s: 12", "duration_s: 0", "out of range"},
    {"DurationNan", "duration_s: 12", "duration_s: .nan", "not a number"},
    {"SeedNegative", "seed: 5", "seed: -5", "out of range"},
    {"SeedFraction", "seed: 5", "seed: 5.5", "expected a whole number"},
    {"Integrator", "integrator: reference", "integrator: euler", "one of: ode, reference"},
    {"StepDoesNotDivide", "step_s: 0.0005", "step_s: 0.0003", "a whole number of steps"},
    {"StepLongerThanPeriod", "step_s: 0.0005", "step_s: 0.004", "a whole number of steps"},
    {"Friction", "friction: false", "friction: most", "found 'most'; expected true or false"},
    {"FrictionAbove", "friction: false", "friction: 10.1", "expected a number from 0 to 10"},
    {"FrictionNegative", "friction: false", "friction: -1", "out of range"},
    {"StartTooShort", "start_q: [0.1, 0.2, 0]", "start_q: [0.1, 0.2]", "a list of 3 numbers"},
    {"StartOutside", "start_q: [0.1, 0.2, 0]", "start_q: [0.1, 0.4, 0]",
     "0.4 for slide is outside"},
    {"Measure", "measure: {stiffness: 0.05}", "measure: 0.05", "expected a mapping or a list"},
    {"MeasureKey", "measure: {stiffness: 0.05}", "measure: {stifness: 0.05}",
     "unknown key 'stifness'; did you mean 'stiffness'?"},
    {"MeasureZero", "measure: {stiffness: 0.05}", "measure: {stiffness: 0}", "out of range"},
    {"MeasureAbove", "measure: {stiffness: 0.05}", "measure: {contact_force: 1.1}", "out of range"},
};
INSTANTIATE_TEST_SUITE_P(Head, ScenarioRefusal, ::testing::ValuesIn(kHead),
                         testing::MutationName());

std::string with_overrides(const std::string& plant) {
  return good_scenario() + "plant_overrides: " + plant + "\n";
}

// The simulated arm would be the same: said, not passed over.
TEST(PlantOverrides, KeysThatChangeNothingAreRefused) {
  for (const char* plant :
       {"{rate_hz: 1000}", "{base: link}", "{gains: {law: joint_impedance}}", "{buses: []}",
        "{watchdog: {timeout_s: 1}}", "{motors: {big: {protocol: moteus}}}",
        "{motors: {big: {peak_torque_Nm: 1}}}", "{motors: {big: {encoder_bits: 8}}}",
        "{motors: {big: {mit_range: {torque_Nm: 1}}}}", "{joints: {turn: {torque_limit_Nm: 1}}}",
        "{joints: {turn: {velocity_limit_rad_per_s: 1}}}", "{joints: {turn: {home_rad: 1}}}",
        "{joints: {turn: {hold: {kp_Nm_per_rad: 1}}}}", "{joints: {turn: {id: 3}}}",
        "{joints: {turn: {bus: right}}}"}) {
    std::string file;
    const std::string complaint = refusal(with_overrides(plant), &file);
    testing::expect_complaint(complaint, file, testing::kNoLine,
                              "cannot differ between robot.yaml and the plant");
  }
}

TEST(PlantOverrides, AreFoundUnderTheirFormerName) {
  const testing::TemporaryFolder folder;
  const std::string file = folder.write(
      "s.yaml", good_scenario() + "reality: {joints: {slide: {friction: {coulomb_N: 30}}}}\n");
  const Scenario scenario = load_scenario(file, arm(), &controller::law_catalog());
  ASSERT_TRUE(scenario.plant);
  EXPECT_EQ(scenario.plant->robot.joints[1].friction.coulomb_Nm, 30.0);
}

TEST(PlantOverrides, WhatIsMountedOtherwiseIs) {
  const testing::TemporaryFolder folder;
  const std::string file =
      folder.write("s.yaml", with_overrides("{joints: {turn: {sign: 1, offset_rad: 0.2}, "
                                            "slide: {friction: {coulomb_N: 30}}}}"));
  const Scenario scenario = load_scenario(file, arm(), &controller::law_catalog());
  ASSERT_TRUE(scenario.plant);
  const std::vector<JointConfig>& real = scenario.plant->robot.joints;
  EXPECT_EQ(real[0].drive.sign, 1.0);
  EXPECT_EQ(real[0].drive.offset_rad, 0.2);
  EXPECT_EQ(real[1].friction.coulomb_Nm, 30.0);
  EXPECT_EQ(real[1].drive.sign, arm().robot.joints[1].drive.sign) << "the rest is robot.yaml's";
}

const Mutation kEntries[] = {
    {"TimeMissing", "{at_s: 0.5, mode: hold}", "{mode: hold}", "timeline[0]: 'at_s' is missing"},
    {"TimeNegative", "at_s: 0.5,", "at_s: -0.5,", "timeline[0].at_s: '-0.5' is out of range"},
    {"TimeAfterTheEnd", "at_s: 11.5", "at_s: 12.5", "'12.5' is out of range; expected a number"},
    {"NothingHappens", "{at_s: 0.5, mode: hold}", "{at_s: 0.5}", "exactly one of: mode, gains"},
    {"TwoThingsHappen", "{at_s: 8, wall: off}", "{at_s: 8, wall: off, mode: hold}",
     "found mode, wall"},
    {"EntryUnknownKey", "mode: hold", "mood: hold", "unknown key 'mood'; did you mean 'mode'?"},
    {"EntryIsText", "{at_s: 8, wall: off}", "wall off", "found 'wall off'; expected a mapping"},
    {"ModeUnknown", "mode: hold", "mode: run", "expected one of: idle, hold, active, stop"},
    {"LawName", "law: cartesian_impedance", "law: Cartesian Impedance",
     "did you mean 'cartesian_impedance'?"},
    {"Orientation", "orientation: quat", "orientation: euler",
     "one of: log, quat, log_simple, quat_simple, rpy"},
    {"StiffnessNegative", "[100, 200, 300]", "[100, -200, 300]", "'-200' is out of range"},
    {"StiffnessTooMuch", "[100, 200, 300]", "[100, 200000, 300]", "from 0 to 100000"},
    {"StiffnessTwoNumbers", "[100, 200, 300]", "[100, 200]",
     "found 2 entries; expected a list of 3"},
    {"StiffnessUnit", "K_x_translation_N_per_m", "K_x_translation_N_per_mm",
     "did you mean 'K_x_translation_N_per_m'?"},
    {"DampingRatio", "damping_ratio: 0.9", "damping_ratio: 9", "from 0 to 2"},
    {"JointStiffnessCount", "K_null_Nm_per_rad: [1, 2, 3]", "K_null_Nm_per_rad: [1, 2]", "of 3"},
    {"Ramp", "ramp_s: 0.2", "ramp_s: -0.2", "out of range"},
    {"MatrixNotSymmetric", "- [10, 100, 0, 0, 0, 1]", "- [20, 100, 0, 0, 0, 1]", "is not symmetric",
     -2},
    {"MatrixIndefinite", "- [0, 1, 0, 0, 0, 5]", "- [0, 1, 0, 0, 0, -5]",
     "is not positive semidefinite", -6},
    {"MatrixTooStiff", "- [0, 0, 0, 5, 0, 0]", "- [0, 0, 0, 50000, 0, 0]", "is above 10000", -4},
    {"MatrixFiveRows", "        - [0, 1, 0, 0, 0, 5]\n", "", "6 lists of 6 numbers",
     testing::kNoLine},
    {"MatrixShortRow", "- [0, 0, 0, 5, 0, 0]", "- [0, 0, 0, 5, 0]", "6 lists of 6 numbers"},
    {"MatrixAndDiagonal", "      K_x:\n", "      K_x_rotation_Nm_per_rad: 5\n      K_x:\n",
     "give either it or its diagonal blocks", 1},
};
INSTANTIATE_TEST_SUITE_P(Entries, ScenarioRefusal, ::testing::ValuesIn(kEntries),
                         testing::MutationName());

const Mutation kThings[] = {
    {"GoalEmpty", "goal: {torque_Nm: [0, 1, 0]}", "goal: {duration_s: 1}", "no goal; expected"},
    {"GoalTwoKinds", "{joints_rad: [0.5, 0.1, 1],",
     "{offset_m: [0, 0, 0], joints_rad: [0.5, 0.1, 1],", "more than one goal"},
    {"GoalPoseWithoutRotation", "quaternion_wxyz: [0.9999, 0, 0, 0], ", "",
     "'quaternion_wxyz' is missing"},
    {"GoalQuaternion", "[0.9999, 0, 0, 0]", "[0.9, 0, 0, 0]", "has length 0.9; expected 1"},
    {"GoalQuaternionZero", "[0.9999, 0, 0, 0]", "[0, 0, 0, 0]", "has length 0; expected 1"},
    {"GoalFarAway", "position_m: [0.3,", "position_m: [300,", "'300' is out of range"},
    {"GoalJointOutside", "joints_rad: [0.5, 0.1, 1]", "joints_rad: [0.5, 0.1, 4]", "4 for roll is"},
    {"GoalJointsCount", "joints_rad: [0.5, 0.1, 1]", "joints_rad: [0.5, 0.1]", "a list of 3"},
    {"GoalPostureWithJoints", "joints_rad: [0.5, 0.1, 1]",
     "joints_rad: [0.5, 0.1, 1], posture_rad: [0, 0, 0]", "goes with a goal of the tip only"},
    {"GoalAngleInDegrees", "offset_rad: [0, 0, 0.1]", "offset_rad: [0, 0, 90]", "out of range"},
    {"GoalForce", "force_N: [0, 0, 5]}", "force_N: [0, 0, 5000]}", "out of range"},
    {"GoalDuration", "duration_s: 2}", "duration_s: -2}", "out of range"},
    {"PushLink", "link: fore", "link: four", "found 'four'; expected one of: upper, fore, hand"},
    {"PushWithoutForce", "force_N: [1, 2, 3], torque_Nm: [0.1, 0, 0], ", "",
     "'force_N' or 'torque_Nm' is missing"},
    {"PushWithoutEnd", ", for_s: 0.5}}\n  - {at_s: 7", "}}\n  - {at_s: 7", "'for_s' is missing"},
    {"PushTooLong", "ramp_s: 0.1, for_s: 0.5", "ramp_s: 0.1, for_s: 61", "out of range"},
    {"PushEdgesTooLong", "ramp_s: 0.1, for_s: 0.5", "ramp_s: 0.3, for_s: 0.5",
     "must fit into for_s"},
    {"PushForceNan", "force_N: [1, 2, 3]", "force_N: [1, nan, 3]", "'nan' is not a number"},
    {"WallNormal", "[-0.6, 0, 0.8]", "[-0.6, 0, 0.9]", "has length 1.08167; expected 1"},
    {"WallNormalZero", "[-0.6, 0, 0.8]", "[0, 0, 0]", "has length 0; expected 1"},
    {"WallStiffness", "stiffness_N_per_m: 5000", "stiffness_N_per_m: 0", "out of range"},
    {"WallOn", "wall: off", "wall: on", "found 'on'; expected one of: off"},
    {"PayloadNegative", "mass_kg: 0.7", "mass_kg: -0.7", "out of range"},
    {"PayloadFarAway", "position_m: [0, 0, 0.1]", "position_m: [0, 0, 10]", "out of range"},
    {"FaultJoint", "joint: slide", "joint: slid", "did you mean 'slide'?"},
    {"FaultSensor", "joint: slide, kind", "sensor: hand, kind", "expected one of: tip"},
    {"FaultWithoutSensor", "joint: slide, kind: frozen_encoder", "sensor: tip, kind: silent",
     "arm has no sensor at the tip"},
    {"FaultKind", "kind: frozen_encoder", "kind: frozen", "one of: silent, frozen_encoder"},
};
INSTANTIATE_TEST_SUITE_P(Things, ScenarioRefusal, ::testing::ValuesIn(kThings),
                         testing::MutationName());

TEST(ScenarioRefusals, TellEveryEntryThatIsWrong) {
  std::string text = good_scenario();
  for (const Mutation& mutation :
       {Mutation{"", "mode: hold", "mode: run", ""}, Mutation{"", "joint: slide", "joint: 2", ""},
        Mutation{"", "mass_kg: 0.7", "mass_kg: heavy", ""}}) {
    text = testing::apply(text, mutation).text;
  }
  std::string file;
  const std::string complaint = refusal(text, &file);
  EXPECT_EQ(std::count(complaint.begin(), complaint.end(), '\n'), 2) << complaint;
}

TEST(ScenarioRefusals, TimelineIsAList) {
  std::string file;
  const std::string complaint =
      refusal("format: limber-scenario/1\nrobot: x\nduration_s: 1\ntimeline: {at_s: 1}\n", &file);
  testing::expect_complaint(complaint, file, 4, "found a mapping; expected a list of mappings");
}

TEST(ScenarioRefusals, NoSuchFile) {
  testing::complaint_of([] { load_scenario("/nowhere.yaml", arm(), &controller::law_catalog()); });
  testing::complaint_of([] { scenario_robot("/nowhere.yaml"); });
}

}  // namespace
}  // namespace limber::test_scenario_refusals
