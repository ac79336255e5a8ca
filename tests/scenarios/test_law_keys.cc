// What a scenario says about laws and circles: every key and every word arrives in the message, and
// one slip in a good file is refused with file, line and key.
#include <fmt/format.h>

#include <limits>
#include <string>
#include <vector>

#include "controller/laws/registry.h"
#include "lcmtypes/gains_merge.h"
#include "robots/loader/default_gains.h"
#include "scenarios/loader/gains_yaml.h"
#include "scenarios/loader/scenario.h"
#include "tests/support/mutation.h"
#include "tests/support/source_path.h"

namespace limber::test_law_keys {
namespace {

using controller::law_catalog;
using testing::Mutation;
using Gains = compliance_gains_t;

const std::string kGood = source_path("tests/scenarios/data/laws.yaml");

const LoadedRobot& arm() {
  static const LoadedRobot robot = load_robot(source_path("tests/robots/data/arm"));
  return robot;
}

template <typename Message>
Message message_at(const Scenario& scenario, double time_s) {
  for (const TimedMessage& timed : scenario.timeline) {
    if (timed.time_ns == static_cast<std::int64_t>(time_s * 1e9))
      return std::get<Message>(timed.message);
  }
  throw std::runtime_error("nothing happens then");
}

std::vector<float> parameter(const Gains& gains, const std::string& key) {
  for (const law_parameter_t& given : gains.parameters) {
    if (given.key == key) return given.values;
  }
  return {};
}

TEST(LawKeys, ChoicesArrive) {
  const auto gains = message_at<Gains>(load_scenario(kGood, arm(), &law_catalog()), 2.0);
  EXPECT_EQ(gains.law, "opspace_impedance");
  EXPECT_EQ(gains.orientation, +Gains::ORIENTATION_RPY);
  EXPECT_EQ(gains.frame, +Gains::FRAME_GOAL);
  EXPECT_EQ(gains.model_compensation, +Gains::COMPENSATION_GRAVITY_CORIOLIS);
  EXPECT_EQ(gains.damping, +Gains::DAMPING_GIVEN);
  EXPECT_EQ(gains.joint_damping, +Gains::DAMPING_FACTORISATION);
  EXPECT_EQ(gains.stiffness_terms, +Gains::STIFFNESS_GEOMETRIC);
  EXPECT_EQ(parameter(gains, "stiffness_pose"), std::vector<float>{3.0F});
  EXPECT_EQ(parameter(gains, "damping_partials"), std::vector<float>{1.0F});
  EXPECT_EQ(gains.projector, +Gains::PROJECTOR_KINEMATIC);
  EXPECT_EQ(gains.contact, +Gains::CONTACT_JOINT_TORQUE);
  EXPECT_EQ(gains.velocity, +Gains::VELOCITY_LEVANT);
  EXPECT_EQ(gains.friction_compensation, +Gains::FRICTION_MODEL);
  EXPECT_EQ(parameter(gains, "inertia_feedforward"), std::vector<float>{1.0F});
  EXPECT_EQ(parameter(gains, "follow_velocity"), std::vector<float>{0.0F});
  EXPECT_EQ(parameter(gains, "literal_stiffness"), std::vector<float>{1.0F});
}

TEST(LawKeys, NumbersArrive) {
  const auto gains = message_at<Gains>(load_scenario(kGood, arm(), &law_catalog()), 2.0);
  EXPECT_EQ(gains.friction_share, 0.5F);
  EXPECT_EQ(gains.velocity_cutoff_rad_per_s, 200.0F);
  EXPECT_EQ(gains.velocity_acceleration_rad_per_s2, 40.0F);
  EXPECT_EQ(gains.acceleration_filter_s, 0.01);
  EXPECT_EQ(gains.observer_gain_per_s, 30.0F);
  EXPECT_EQ(gains.tank_J, 2.0F);
  EXPECT_EQ(gains.passivity_damping_Ns_per_m, 12.0F);
  EXPECT_EQ(gains.spring_force_N, 60.0F);
  EXPECT_EQ(gains.spring_moment_Nm, 8.0F);
  EXPECT_EQ(gains.D_x[0][1], 1.0F);
  EXPECT_EQ(gains.D_x[5][5], 2.0F);
  EXPECT_EQ(gains.M_x[1][0], -1.0F);
  EXPECT_EQ(gains.M_x[2][2], -3.0F) << "accel_feedback may take inertia away";
  EXPECT_EQ(gains.D_q[1], 2.0F);
  EXPECT_EQ(parameter(gains, "M_q_kgm2"), std::vector<float>(3, 0.5F));
  EXPECT_EQ(parameter(gains, "K_acc_per_s2"), std::vector<float>(3, 64.0F));
  for (int i = 0; i < 5; ++i) EXPECT_EQ(gains.period_cycles[i], 2 + i);
}

TEST(LawKeys, LaterEntriesKeepWhatTheyDoNotName) {
  const Scenario scenario = load_scenario(kGood, arm(), &law_catalog());
  Gains gains = default_gains(arm().robot);
  for (const double time_s : {2.0, 3.0}) merge_gains(message_at<Gains>(scenario, time_s), &gains);
  EXPECT_EQ(gains.period_cycles[Gains::PERIOD_C], 9);
  EXPECT_EQ(gains.period_cycles[Gains::PERIOD_D], 6);
  EXPECT_EQ(gains.frame, +Gains::FRAME_GOAL);
  EXPECT_EQ(gains.D_x[0][1], 1.0F);
}

TEST(LawKeys, CircleArrives) {
  const auto goal = message_at<compliance_goal_t>(load_scenario(kGood, arm(), &law_catalog()), 4.0);
  EXPECT_EQ(goal.kind, +compliance_goal_t::GOAL_CIRCLE);
  EXPECT_EQ(goal.offset[0], 0.1);
  EXPECT_NEAR(goal.offset[4], 0.6, 1e-15);
  EXPECT_NEAR(goal.offset[5], 0.8, 1e-15);
  EXPECT_EQ(goal.duration_s, 2.0);
  EXPECT_EQ(goal.F_ff[1], 1.0);
}

TEST(LawKeys, DefaultsAreTheLawsOwn) {
  const Gains gains = message_at<Gains>(
      [] {
        const testing::TemporaryFolder folder;
        return load_scenario(folder.write("s.yaml",
                                          "format: limber-scenario/1\nrobot: x\nduration_s: 2\n"
                                          "timeline:\n  - {at_s: 1, gains: {ramp_s: 0.1}}\n"),
                             arm(), &law_catalog());
      }(),
      1.0);
  EXPECT_EQ(gains.model_compensation, +Gains::COMPENSATION_LAW_DEFAULT);
  EXPECT_EQ(gains.damping, +Gains::DAMPING_DOUBLE_DIAGONALISATION);
  EXPECT_EQ(gains.stiffness_terms, +Gains::STIFFNESS_FULL);
  EXPECT_EQ(gains.friction_share, 0.8F);
  EXPECT_EQ(gains.period_cycles[2], 1);
  EXPECT_TRUE(gains.parameters.empty()) << "the controller has the laws' defaults";
}

std::vector<const GainRow*> every_row() {
  std::vector<const GainRow*> rows = law_catalog().parameters;
  for (const GainRow& row : gain_table()) rows.push_back(&row);
  return rows;
}

// The value that `key: text` gives, of what has one; throws what the reader throws.
double read(const GainRow& row, const std::string& text) {
  const YamlMap yaml = YamlMap::from_text(fmt::format("{}: {}", row.key, text), "entry");
  const Gains gains = read_gains_entry(yaml, arm().robot, law_catalog());
  if (const auto* f = std::get_if<double Gains::*>(&row.field)) return gains.**f;
  if (const auto* f = std::get_if<float Gains::*>(&row.field)) return gains.**f;
  if (const auto* f = std::get_if<std::int8_t Gains::*>(&row.field)) return gains.**f;
  if (const auto* f = std::get_if<double(Gains::*)[16]>(&row.field)) return (gains.**f)[1];
  if (const auto* f = std::get_if<float(Gains::*)[16]>(&row.field)) return (gains.**f)[1];
  if (std::holds_alternative<std::monostate>(row.field)) return parameter(gains, row.key).at(0);
  return std::numeric_limits<double>::quiet_NaN();
}

TEST(GainTable, EveryWordIsItsValueAndNoOtherIsTaken) {
  for (const GainRow* row : every_row()) {
    if (!row->is_choice() || row->key == std::string("period_cycles")) continue;
    SCOPED_TRACE(row->key);
    std::string words;
    for (const GainWord& word : row->words) {
      EXPECT_EQ(read(*row, word.word), word.value) << word.word;
      words += (words.empty() ? "" : ", ") + std::string(word.word);
    }
    const std::string complaint = testing::complaint_of([&] { read(*row, "wishful"); });
    EXPECT_NE(complaint.find(row->key), std::string::npos) << complaint;
    if (!row->is_switch()) {
      EXPECT_NE(complaint.find(words), std::string::npos) << complaint;
    }
  }
}

TEST(GainTable, EveryNumberArrivesAndItsRangeHolds) {
  int numbers = 0;
  for (const GainRow* row : every_row()) {
    if (row->is_choice() || row->high_rotation > 0.0) continue;
    SCOPED_TRACE(row->key);
    const double middle = 0.5 * (row->low + row->high);
    EXPECT_NEAR(read(*row, fmt::format("{}", middle)), middle, 1e-6 * row->high);
    EXPECT_NEAR(read(*row, fmt::format("{}", row->high)), row->high, 1e-6 * row->high);
    for (const double wrong : {row->low - 1.0, 1.001 * row->high}) {
      const std::string text = fmt::format("{}", wrong);
      const std::string complaint = testing::complaint_of([&] { read(*row, text); });
      EXPECT_NE(complaint.find(row->key), std::string::npos) << complaint;
      EXPECT_NE(complaint.find("out of range"), std::string::npos) << complaint;
    }
    EXPECT_TRUE(row->from_robot || (row->standard >= row->low && row->standard <= row->high))
        << "the default is allowed, or 0 stands for the arm's own";
    EXPECT_GT(std::string(row->meaning).size(), 10U);
    ++numbers;
  }
  EXPECT_GT(numbers, 15);
}

TEST(GainTable, NoKeyTwice) {
  std::vector<std::string> keys;
  for (const GainRow* row : every_row()) keys.emplace_back(row->key);
  std::sort(keys.begin(), keys.end());
  EXPECT_EQ(std::adjacent_find(keys.begin(), keys.end()), keys.end());
}

// Each field of the message stands in exactly one row: none can be forgotten.
TEST(GainTable, EveryFieldHasARow) {
  std::vector<GainField> fields;
  for (const GainRow& row : gain_table()) fields.push_back(row.field);
  fields.push_back(ramp_row().field);
  const std::string lcm = testing::read_text(source_path("lcmtypes/compliance_gains_t.lcm"));
  int declared = 0;
  for (std::size_t at = 0; (at = lcm.find(";\n", at)) != std::string::npos; ++at) {
    const std::size_t start = lcm.rfind('\n', at) + 1;
    declared += lcm.compare(start, 4, "    ") == 0 && lcm.compare(start, 9, "    const") != 0 &&
                lcm.compare(start, 6, "    //") != 0;
  }
  constexpr int kHead = 9;        // seq .. client, scope, num_named, named, law, num_joints
  constexpr int kParameters = 2;  // and their number
  EXPECT_EQ(declared, std::ssize(fields) + kHead + kParameters);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(fields[i] == fields[j]);
  }
}

class LawKeyRefusal : public ::testing::TestWithParam<Mutation> {};

TEST_P(LawKeyRefusal, NamesPlaceAndProblem) {
  const testing::Mutated bad = testing::apply(testing::read_text(kGood), GetParam());
  const testing::TemporaryFolder folder;
  const std::string file = folder.write("s.yaml", bad.text);
  const std::string complaint =
      testing::complaint_of([&] { load_scenario(file, arm(), &law_catalog()); });
  testing::expect_complaint(complaint, file, bad.line, GetParam().expect);
}

const Mutation kSlips[] = {
    {"Switch", "inertia_feedforward: true", "inertia_feedforward: 1", "expected true or false"},
    {"Misspelt", "stiffness_pose", "stifness_pose", "did you mean 'stiffness_pose'?"},
    {"FrictionShare", "friction_share: 0.5", "friction_share: 1.5", "'1.5' is out of range"},
    {"Cutoff", "velocity_cutoff_rad_per_s: 200", "velocity_cutoff_rad_per_s: -1", "out of range"},
    {"Acceleration", "velocity_acceleration_rad_per_s2: 40",
     "velocity_acceleration_rad_per_s2: 2e5", "out of range"},
    {"Filter", "acceleration_filter_s: 0.01", "acceleration_filter_s: 10", "out of range"},
    {"ObserverZero", "observer_gain_per_s: 30", "observer_gain_per_s: 0", "out of range"},
    {"UnknownLaw", "law: opspace_impedance", "law: opspace_impedence",
     "did you mean 'opspace_impedance'?"},
    {"Observer", "observer_gain_per_s: 30", "observer_gain_per_s: 501", "out of range"},
    {"Tank", "tank_J: 2", "tank_J: nan", "not a number"},
    {"Passivity", "passivity_damping_Ns_per_m: 12", "passivity_damping_Ns_per_m: 2e3",
     "out of range"},
    {"SpringForce", "spring_force_N: 60", "spring_force_N: -60", "out of range"},
    {"SpringMoment", "spring_moment_Nm: 8", "spring_moment_Nm: 20000", "out of range"},
    {"DampingNotSymmetric", "- [1, 20, 0, 0, 0, 0]", "- [2, 20, 0, 0, 0, 0]", "is not symmetric",
     -2},
    {"DampingIndefinite", "- [0, 0, 0, 2, 0, 0]", "- [0, 0, 0, -2, 0, 0]",
     "is not positive semidefinite", -4},
    {"DampingTooMuch", "- [0, 0, 0, 2, 0, 0]", "- [0, 0, 0, 2000, 0, 0]", "is above 1000", -4},
    {"InertiaNotSymmetric", "- [-1, 3, 0, 0, 0, 0]", "- [1, 3, 0, 0, 0, 0]", "is not symmetric",
     -2},
    {"InertiaTooMuch", "- [0, 0, 0, 0.1, 0, 0]", "- [0, 0, 0, 200, 0, 0]", "is above 100", -4},
    {"JointDamping", "D_q_Nms_per_rad: [1, 2, 3]", "D_q_Nms_per_rad: [1, 2]", "a list of 3"},
    {"JointInertia", "M_q_kgm2: 0.5", "M_q_kgm2: 101", "out of range"},
    {"StiffnessPerInertia", "K_acc_per_s2: 64", "K_acc_per_s2: -64", "out of range"},
    {"PeriodZero", "{jacobian: 2,", "{jacobian: 0,", "period_cycles.jacobian"},
    {"PeriodFraction", "inertia: 3,", "inertia: 3.5,", "expected a whole number"},
    {"PeriodTooLong", "damping: 6}", "damping: 1001}", "out of range"},
    {"PeriodUnknown", "coriolis: 4,", "corioli: 4,", "did you mean 'coriolis'?"},
    {"CircleWithoutAxis", "circle_axis: [0, 0.6, 0.8], ", "", "'circle_axis' is missing"},
    {"CircleWithoutCentre", "circle_centre_m: [0.1, 0, 0], ", "", "'circle_centre_m' is missing"},
    {"CircleAxis", "[0, 0.6, 0.8]", "[0, 0.6, 0.9]", "circle_axis"},
    {"CircleFarAway", "circle_centre_m: [0.1,", "circle_centre_m: [11,", "out of range"},
    {"CircleAndOffset", "circle_axis: [0, 0.6, 0.8],",
     "circle_axis: [0, 0.6, 0.8], offset_m: [0, 0, 0],", "more than one goal"},
    {"CircleAndPosture", "circle_axis: [0, 0.6, 0.8],",
     "circle_axis: [0, 0.6, 0.8], posture_rad: [0, 0, 0],", "goes with a goal of the tip only"},
};
INSTANTIATE_TEST_SUITE_P(Slips, LawKeyRefusal, ::testing::ValuesIn(kSlips),
                         testing::MutationName());

}  // namespace
}  // namespace limber::test_law_keys
