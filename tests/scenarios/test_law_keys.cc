// What a scenario says about laws and circles: every key and every word arrives in the message, and
// one slip in a good file is refused with file, line and key.
#include <string>
#include <vector>

#include "scenarios/scenario.h"
#include "tests/support/mutation.h"

namespace limber {
namespace {

using testing::Mutation;
using Gains = compliance_gains_t;

const std::string kGood = LIMBER_SOURCE_DIR "/tests/scenarios/data/laws.yaml";

const LoadedRobot& arm() {
  static const LoadedRobot robot = load_robot(LIMBER_SOURCE_DIR "/tests/robots/data/arm");
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

TEST(LawKeys, ChoicesArrive) {
  const auto gains = message_at<Gains>(load_scenario(kGood, arm()), 2.0);
  EXPECT_EQ(gains.law, "opspace_impedance");
  EXPECT_EQ(gains.orientation, +Gains::ORIENTATION_RPY);
  EXPECT_EQ(gains.frame, +Gains::FRAME_GOAL);
  EXPECT_EQ(gains.bias, +Gains::BIAS_GRAVITY_CORIOLIS);
  EXPECT_EQ(gains.damping, +Gains::DAMPING_GIVEN);
  EXPECT_EQ(gains.joint_damping, +Gains::DAMPING_FACTORISATION);
  EXPECT_EQ(gains.stiffness_terms, +Gains::STIFFNESS_GEOMETRIC);
  EXPECT_EQ(gains.stiffness_pose, +Gains::POSE_MEAN);
  EXPECT_EQ(gains.damping_partials, +Gains::PARTIALS_IN_STIFFNESS);
  EXPECT_EQ(gains.projector, +Gains::PROJECTOR_KINEMATIC);
  EXPECT_EQ(gains.contact, +Gains::CONTACT_JOINT_TORQUE);
  EXPECT_EQ(gains.velocity, +Gains::VELOCITY_LEVANT);
  EXPECT_EQ(gains.friction, +Gains::FRICTION_MODEL);
  EXPECT_EQ(gains.inertia_feedforward, 1);
  EXPECT_EQ(gains.follow_velocity, 0);
  EXPECT_EQ(gains.literal_stiffness, 1);
}

TEST(LawKeys, NumbersArrive) {
  const auto gains = message_at<Gains>(load_scenario(kGood, arm()), 2.0);
  EXPECT_EQ(gains.friction_share, 0.5F);
  EXPECT_EQ(gains.velocity_cutoff_rad_per_s, 200.0F);
  EXPECT_EQ(gains.velocity_acceleration_rad_per_s2, 40.0F);
  EXPECT_EQ(gains.acceleration_filter_s, 0.01F);
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
  EXPECT_EQ(gains.M_q[2], 0.5F);
  EXPECT_EQ(gains.K_acc[0], 64.0F);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(gains.period_cycles[i], 2 + i);
}

TEST(LawKeys, LaterEntriesKeepWhatTheyDoNotName) {
  const auto gains = message_at<Gains>(load_scenario(kGood, arm()), 3.0);
  EXPECT_EQ(gains.period_cycles[Gains::PERIOD_C], 9);
  EXPECT_EQ(gains.period_cycles[Gains::PERIOD_D], 6);
  EXPECT_EQ(gains.frame, +Gains::FRAME_GOAL);
  EXPECT_EQ(gains.D_x[0][1], 1.0F);
}

TEST(LawKeys, CircleArrives) {
  const auto goal = message_at<compliance_goal_t>(load_scenario(kGood, arm()), 4.0);
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
                             arm());
      }(),
      1.0);
  EXPECT_EQ(gains.bias, +Gains::BIAS_OF_LAW);
  EXPECT_EQ(gains.damping, +Gains::DAMPING_DOUBLE_DIAGONALISATION);
  EXPECT_EQ(gains.stiffness_terms, +Gains::STIFFNESS_FULL);
  EXPECT_EQ(gains.stiffness_pose, +Gains::POSE_MID);
  EXPECT_EQ(gains.follow_velocity, 1);
  EXPECT_EQ(gains.friction_share, 0.8F);
  EXPECT_EQ(gains.K_acc[2], 100.0F);
}

struct Words {
  std::string key;
  std::string present;  ///< in the good file
  std::int8_t Gains::*field;
  std::vector<std::string> words;  ///< in the order of the message's constants
};

const std::vector<std::string> kDesigns = {"double_diagonalisation", "factorisation", "given",
                                           "without_inertia"};
const Words kWords[] = {
    {"orientation",
     "rpy",
     &Gains::orientation,
     {"log", "quat", "log_simple", "quat_simple", "rpy"}},
    {"frame", "goal", &Gains::frame, {"base", "goal"}},
    {"bias", "gravity_coriolis", &Gains::bias, {"of_law", "none", "gravity", "gravity_coriolis"}},
    {"damping", "given", &Gains::damping, kDesigns},
    {"joint_damping", "factorisation", &Gains::joint_damping, kDesigns},
    {"stiffness_terms", "geometric", &Gains::stiffness_terms, {"first", "geometric", "full"}},
    {"stiffness_pose", "mean", &Gains::stiffness_pose, {"current", "goal", "mid", "mean"}},
    {"damping_partials",
     "in_stiffness",
     &Gains::damping_partials,
     {"none", "in_stiffness", "printed"}},
    {"projector", "kinematic", &Gains::projector, {"dynamic", "kinematic", "none"}},
    {"contact", "joint_torque", &Gains::contact, {"none", "tip_sensor", "joint_torque"}},
    {"velocity",
     "levant",
     &Gains::velocity,
     {"drive", "filtered_difference", "alpha_beta", "levant"}},
    {"friction_compensation", "model", &Gains::friction, {"none", "model", "observer"}},
};

TEST(LawKeys, EveryWordIsItsConstantAndNoOtherIsTaken) {
  const std::string good = testing::read_text(kGood);
  for (const Words& choice : kWords) {
    const std::string line = "      " + choice.key + ": ";
    const auto with = [&](const std::string& word) {
      return testing::apply(good, {"", line + choice.present + "\n", line + word + "\n", ""});
    };
    const testing::TemporaryFolder folder;
    for (std::size_t i = 0; i < choice.words.size(); ++i) {
      const std::string file = folder.write("s.yaml", with(choice.words[i]).text);
      const auto gains = message_at<Gains>(load_scenario(file, arm()), 2.0);
      EXPECT_EQ(gains.*choice.field, static_cast<int>(i)) << choice.key << ": " << choice.words[i];
    }
    const testing::Mutated bad = with("wishful");
    const std::string file = folder.write("s.yaml", bad.text);
    const std::string complaint = testing::complaint_of([&] { load_scenario(file, arm()); });
    std::string expected = "'wishful'; expected one of: ";
    for (const std::string& word : choice.words) {
      expected += (&word == choice.words.data() ? "" : ", ") + word;
    }
    testing::expect_complaint(complaint, file, bad.line, choice.key);
    testing::expect_complaint(complaint, file, bad.line, expected);
  }
}

class LawKeyRefusal : public ::testing::TestWithParam<Mutation> {};

TEST_P(LawKeyRefusal, NamesPlaceAndProblem) {
  const testing::Mutated bad = testing::apply(testing::read_text(kGood), GetParam());
  const testing::TemporaryFolder folder;
  const std::string file = folder.write("s.yaml", bad.text);
  const std::string complaint = testing::complaint_of([&] { load_scenario(file, arm()); });
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
    {"Observer", "observer_gain_per_s: 30", "observer_gain_per_s: 501", "out of range"},
    {"Tank", "tank_J: 2", "tank_J: nan", "not a number"},
    {"Passivity", "passivity_damping_Ns_per_m: 12", "passivity_damping_Ns_per_m: 2e3",
     "out of range"},
    {"SpringForce", "spring_force_N: 60", "spring_force_N: -60", "out of range"},
    {"SpringMoment", "spring_moment_Nm: 8", "spring_moment_Nm: 20000", "out of range"},
    {"DampingNotSymmetric", "- [1, 20, 0, 0, 0, 0]", "- [2, 20, 0, 0, 0, 0]", "is not symmetric",
     -2},
    {"DampingIndefinite", "- [0, 0, 0, 2, 0, 0]", "- [0, 0, 0, -2, 0, 0]",
     "such a damper would drive the arm", -4},
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
}  // namespace limber
