// What a scenario file says arrives in the messages, in order and complete.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "controller/laws/registry.h"
#include "lcmtypes/gains_merge.h"
#include "scenarios/loader/scenario.h"
#include "tests/support/mutation.h"
#include "tests/support/source_path.h"
#include "tools/allocations/allocations.h"

namespace limber::test_load_scenario {
namespace {

const std::string kGood = source_path("tests/scenarios/data/good.yaml");

class GoodScenario : public ::testing::Test {
 protected:
  template <typename Message>
  const Message& at(double time_s) const {
    for (const TimedMessage& timed : scenario_.timeline) {
      if (timed.time_ns == static_cast<std::int64_t>(time_s * 1e9))
        return std::get<Message>(timed.message);
    }
    throw std::runtime_error("nothing happens then");
  }

  const LoadedRobot robot_ = load_robot(scenario_robot(kGood));
  const Scenario scenario_ = load_scenario(kGood, robot_, &controller::law_catalog());
};

TEST_F(GoodScenario, HeadIsRead) {
  EXPECT_EQ(robot_.robot.name, "arm");  // found relative to the scenario's folder
  EXPECT_EQ(scenario_.name, "good");
  EXPECT_FALSE(scenario_.lockstep);
  EXPECT_EQ(scenario_.duration_s, 12.0);
  EXPECT_EQ(scenario_.seed, 5u);
  EXPECT_EQ(scenario_.integrator, Integrator::kReference);
  EXPECT_EQ(scenario_.step_s, 0.0005);
  EXPECT_FALSE(scenario_.friction);
  EXPECT_TRUE(scenario_.record);
  EXPECT_EQ(scenario_.measure.stiffness, 0.05);
  EXPECT_EQ(scenario_.measure.contact_force, 0.02);
  EXPECT_FALSE(scenario_.stand);
  EXPECT_EQ(scenario_.start_q, (std::vector<double>{0.1, 0.2, 0.0}));
}

TEST_F(GoodScenario, TimelineIsSortedAndNumbered) {
  std::int64_t seq = 0;
  std::int64_t time_ns = 0;
  for (const TimedMessage& timed : scenario_.timeline) {
    EXPECT_GE(timed.time_ns, time_ns);
    time_ns = timed.time_ns;
    std::visit(
        [&](const auto& message) {
          EXPECT_EQ(message.seq, ++seq);
          EXPECT_EQ(message.time_ns, timed.time_ns);
        },
        timed.message);
  }
  EXPECT_EQ(seq, 16);
}

TEST_F(GoodScenario, ModesComeFromTheScenariosClient) {
  EXPECT_EQ(at<mode_request_t>(0.5).request, +mode_request_t::REQUEST_HOLD);
  EXPECT_EQ(at<mode_request_t>(1.0).request, +mode_request_t::REQUEST_ACTIVE);
  EXPECT_EQ(at<mode_request_t>(11.5).request, +mode_request_t::REQUEST_STOP);
  EXPECT_EQ(at<mode_request_t>(0.5).client, kScenarioClient);
  EXPECT_EQ(at<compliance_gains_t>(2.0).client, kScenarioClient);
  EXPECT_EQ(at<compliance_goal_t>(4.0).client, kScenarioClient);
}

TEST_F(GoodScenario, GainsAreComplete) {
  const auto& gains = at<compliance_gains_t>(2.0);
  EXPECT_EQ(gains.law, "cartesian_impedance");
  EXPECT_EQ(gains.orientation, +compliance_gains_t::ORIENTATION_QUAT);
  EXPECT_EQ(gains.num_joints, 3);
  EXPECT_EQ(gains.ramp_s, 0.2);
  const double diagonal[] = {100, 200, 300, 5, 5, 5};
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) EXPECT_EQ(gains.K_x[i][j], i == j ? diagonal[i] : 0.0);
  }
  EXPECT_EQ(gains.K_q[2], 30.0);
  EXPECT_EQ(gains.K_null[1], 2.0);
  EXPECT_EQ(gains.D_null[0], 0.5);
  EXPECT_EQ(gains.K_q[3], 0.0);  // no fourth joint
}

TEST_F(GoodScenario, LaterGainsKeepWhatTheyDoNotName) {
  const auto& later = at<compliance_gains_t>(3.0);
  EXPECT_EQ(later.law, "");
  EXPECT_EQ(later.ramp_s, 0.0);
  compliance_gains_t gains = at<compliance_gains_t>(2.0);
  merge_gains(later, &gains);
  EXPECT_EQ(gains.damping_ratio, 1.0);
  EXPECT_EQ(gains.K_x[1][1], 200.0);
  EXPECT_EQ(gains.K_null[1], 2.0);
  EXPECT_EQ(gains.orientation, +compliance_gains_t::ORIENTATION_QUAT);
}

TEST_F(GoodScenario, WholeMatrix) {
  const auto& gains = at<compliance_gains_t>(11.0);
  EXPECT_EQ(gains.K_x[0][1], 10.0);
  EXPECT_EQ(gains.K_x[1][0], 10.0);
  EXPECT_EQ(gains.K_x[1][5], 1.0);
  EXPECT_EQ(gains.K_x[5][1], 1.0);
}

TEST_F(GoodScenario, Goals) {
  const auto& offset = at<compliance_goal_t>(3.5);
  EXPECT_EQ(offset.kind, +compliance_goal_t::GOAL_OFFSET);
  EXPECT_EQ(offset.offset[0], 0.01);
  EXPECT_EQ(offset.offset[5], 0.1);
  EXPECT_EQ(offset.duration_s, 1.0);
  EXPECT_EQ(offset.use_posture, 1);
  EXPECT_EQ(offset.q[1], 0.1);
  const auto& pose = at<compliance_goal_t>(4.0);
  EXPECT_EQ(pose.kind, +compliance_goal_t::GOAL_POSE);
  EXPECT_EQ(pose.p_BD[1], 0.1);
  EXPECT_EQ(pose.quat_BD[0], 1.0);  // 0.9999 is a rounded 1
  EXPECT_EQ(pose.F_ff[2], 5.0);
  EXPECT_EQ(pose.use_posture, 0);
  const auto& joints = at<compliance_goal_t>(5.0);
  EXPECT_EQ(joints.kind, +compliance_goal_t::GOAL_JOINT);
  EXPECT_EQ(joints.q[2], 1.0);
  const auto& wrench = at<compliance_goal_t>(5.5);
  EXPECT_EQ(wrench.kind, +compliance_goal_t::GOAL_WRENCH);
  EXPECT_EQ(wrench.F_ff[4], 1.0);
}

TEST_F(GoodScenario, World) {
  const auto& push = at<push_t>(6.0);
  EXPECT_EQ(push.id, 3);
  EXPECT_EQ(push.link, "fore");
  EXPECT_EQ(push.wrench[2], 3.0);
  EXPECT_EQ(push.wrench[3], 0.1);
  EXPECT_EQ(push.duration_s, 0.5);
  const auto& wall = at<scenario_event_t>(7.0);
  EXPECT_EQ(wall.kind, +scenario_event_t::EVENT_WALL);
  EXPECT_EQ(wall.point[0], 0.5);
  EXPECT_NEAR(wall.normal[0], -0.6, 1e-15);
  EXPECT_EQ(wall.stiffness_N_per_m, 5000.0);
  EXPECT_EQ(wall.damping_Ns_per_m, 20.0);
  EXPECT_EQ(at<scenario_event_t>(8.0).kind, +scenario_event_t::EVENT_WALL);
  EXPECT_EQ(at<scenario_event_t>(8.0).stiffness_N_per_m, 0.0);
  EXPECT_EQ(at<scenario_event_t>(8.5).kind, +scenario_event_t::EVENT_PAYLOAD);
  EXPECT_EQ(at<scenario_event_t>(8.5).payload_mass_kg, 0.7);
  EXPECT_EQ(at<scenario_event_t>(8.5).payload_position[2], 0.1);
  EXPECT_EQ(at<scenario_event_t>(9.0).payload_mass_kg, 0.0);
  const auto& fault = at<scenario_event_t>(10.0);
  EXPECT_EQ(fault.kind, +scenario_event_t::EVENT_FAULT);
  EXPECT_EQ(fault.joint, 1);
  EXPECT_EQ(fault.fault, +scenario_event_t::FAULT_FROZEN_ENCODER);
  EXPECT_EQ(fault.duration_s, 0.5);
}

Scenario load_text(const std::string& rest, const LoadedRobot& robot) {
  const testing::TemporaryFolder folder;
  return load_scenario(
      folder.write("short.yaml", "format: limber-scenario/1\nrobot: desktop2r\n" + rest), robot,
      &controller::law_catalog());
}

TEST(LoadScenario, TheRobotBesideTheFileComesFirst) {
  const testing::TemporaryFolder folder;
  const std::string file =
      folder.write("first.yaml", "format: limber-scenario/1\nrobot: openarm\nduration_s: 1\n");
  std::string note;
  EXPECT_EQ(scenario_robot(file, &note), "openarm");  // the shipped one
  EXPECT_EQ(note, "");
  std::filesystem::create_directory(folder.path() + "/openarm");
  folder.write("openarm/robot.yaml", "");
  EXPECT_EQ(scenario_robot(file, &note), folder.path() + "/openarm");
  EXPECT_NE(note.find("first.yaml:2: robot: 'openarm' is the folder beside this file"),
            std::string::npos);
}

TEST(LoadScenario, DefaultsAreALockstepRunFromHome) {
  const LoadedRobot robot = load_robot("desktop2r");
  const Scenario scenario = load_text("duration_s: 2\n", robot);
  EXPECT_EQ(scenario.name, "short");
  EXPECT_TRUE(scenario.lockstep);
  EXPECT_TRUE(scenario.friction);
  EXPECT_TRUE(scenario.stand);
  EXPECT_EQ(scenario.integrator, Integrator::kOde);
  EXPECT_EQ(scenario.start_q, (std::vector<double>{-1.2, 1.4}));
  // Nobody asks for a mode: hold, then active.
  ASSERT_EQ(scenario.timeline.size(), 2u);
  EXPECT_EQ(scenario.timeline[0].time_ns, 300'000'000);
  EXPECT_EQ(std::get<mode_request_t>(scenario.timeline[0].message).request,
            +mode_request_t::REQUEST_HOLD);
  EXPECT_EQ(scenario.timeline[1].time_ns, 800'000'000);
  EXPECT_EQ(std::get<mode_request_t>(scenario.timeline[1].message).request,
            +mode_request_t::REQUEST_ACTIVE);
}

TEST(LoadScenario, AFactorOfFrictionIsThatOfTheSimulatedArm) {
  const LoadedRobot robot = load_robot("desktop2r");
  const FrictionConfig& believed = robot.robot.joints[0].friction;
  ASSERT_GT(believed.coulomb_Nm, 0.0);
  const Scenario less = load_text("duration_s: 2\nfriction: 0.5\n", robot);
  EXPECT_TRUE(less.friction);
  EXPECT_EQ(less.friction_factor, 0.5);
  const FrictionConfig& real = less.plant->robot.joints[0].friction;
  EXPECT_EQ(real.coulomb_Nm, 0.5 * believed.coulomb_Nm);
  EXPECT_EQ(real.static_Nm, 0.5 * believed.static_Nm);
  EXPECT_EQ(real.viscous_Nms_per_rad, 0.5 * believed.viscous_Nms_per_rad);
  EXPECT_EQ(real.bristle_rad, believed.bristle_rad);
  EXPECT_FALSE(load_text("duration_s: 2\nfriction: 1\n", robot).plant);
  EXPECT_FALSE(load_text("duration_s: 2\nfriction: 0\n", robot).friction);
}

TEST(LoadScenario, EveryKindOfADrivesFault) {
  const LoadedRobot robot = load_robot("desktop2r");
  const std::map<std::string, int> kinds = {
      {"silent", scenario_event_t::FAULT_SILENT},
      {"frozen_encoder", scenario_event_t::FAULT_FROZEN_ENCODER},
      {"drive_error", scenario_event_t::FAULT_DRIVE_ERROR},
      {"drop_commands", scenario_event_t::FAULT_DROP_COMMANDS},
      {"hot", scenario_event_t::FAULT_HOT}};
  for (const auto& [word, number] : kinds) {
    const Scenario scenario = load_text(
        "duration_s: 2\ntimeline: [{at_s: 1, fault: {joint: " + robot.robot.joints[1].name +
            ", kind: " + word + "}}]\n",
        robot);
    EXPECT_EQ(std::get<scenario_event_t>(scenario.timeline.back().message).fault, number) << word;
  }
}

TEST(LoadScenario, FirstGainsStartFromTheRobots) {
  const LoadedRobot robot = load_robot("desktop2r");
  const Scenario scenario =
      load_text("duration_s: 2\ntimeline: [{at_s: 0.1, gains: {damping_ratio: 1}}]\n", robot);
  const auto& gains = std::get<compliance_gains_t>(scenario.timeline[0].message);
  EXPECT_EQ(gains.K_x[0][0], 300.0);
  EXPECT_EQ(gains.K_x[5][5], 0.0);
  EXPECT_EQ(gains.K_q[0], 40.0);
  EXPECT_EQ(gains.K_q[1], 20.0);
  EXPECT_EQ(gains.damping_ratio, 1.0);
}

TEST(LoadScenario, ADiagonalClearsTheCouplingOfItsBlock) {
  const LoadedRobot robot = load_robot("desktop2r");
  const std::string matrix =
      "[[9, 1, 0, 0, 0, 2], [1, 9, 0, 0, 0, 0], [0, 0, 9, 0, 0, 0], [0, 0, 0, 7, 1, 0], "
      "[0, 0, 0, 1, 7, 0], [2, 0, 0, 0, 0, 7]]";
  const Scenario scenario =
      load_text("duration_s: 2\ntimeline:\n  - {at_s: 0.1, gains: {K_x: " + matrix +
                    "}}\n  - {at_s: 0.2, gains: {K_x_rotation_Nm_per_rad: 3}}\n",
                robot);
  auto gains = std::get<compliance_gains_t>(scenario.timeline[0].message);
  merge_gains(std::get<compliance_gains_t>(scenario.timeline[1].message), &gains);
  EXPECT_EQ(gains.K_x[0][1], 1.0);
  EXPECT_EQ(gains.K_x[0][5], 0.0);
  EXPECT_EQ(gains.K_x[5][0], 0.0);
  EXPECT_EQ(gains.K_x[3][4], 0.0);
  EXPECT_EQ(gains.K_x[3][3], 3.0);
}

TEST(LoadScenario, EntriesMayStandInAnyOrder) {
  const LoadedRobot robot = load_robot("desktop2r");
  const Scenario scenario = load_text(
      "duration_s: 2\ntimeline:\n  - {at_s: 1, mode: stop}\n  - {at_s: 0.5, mode: hold}\n"
      "  - {at_s: 1, mode: idle}\n",
      robot);
  ASSERT_EQ(scenario.timeline.size(), 3u);
  const std::int8_t expected[] = {mode_request_t::REQUEST_HOLD, mode_request_t::REQUEST_STOP,
                                  mode_request_t::REQUEST_IDLE};
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(std::get<mode_request_t>(scenario.timeline[i].message).request, expected[i]);
}

TEST(LoadScenario, ShippedScenariosLoad) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source_path("scenarios"))) {
    if (entry.path().extension() != ".yaml") continue;
    const LoadedRobot robot = load_robot(scenario_robot(entry.path()));
    const Scenario scenario = load_scenario(entry.path(), robot, &controller::law_catalog());
    EXPECT_FALSE(scenario.timeline.empty()) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 5);
}

TEST(Timeline, GivesEachMessageOnceWhenItsTimeHasCome) {
  const std::vector<TimedMessage> messages = {
      {10, mode_request_t()}, {10, push_t()}, {20, compliance_goal_t()}};
  Timeline timeline(&messages);
  EXPECT_EQ(timeline.due(9), nullptr);
  const long before = allocations();
  EXPECT_EQ(timeline.due(10), &messages[0].message);
  EXPECT_EQ(timeline.due(10), &messages[1].message);
  EXPECT_EQ(timeline.due(19), nullptr);
  EXPECT_EQ(timeline.due(500), &messages[2].message);
  EXPECT_EQ(timeline.due(500), nullptr);
  EXPECT_EQ(allocations(), before);
  timeline.rewind();
  EXPECT_EQ(timeline.due(15), &messages[0].message);
}

TEST(Timeline, EmptyOrAbsentHasNothing) {
  const std::vector<TimedMessage> none;
  EXPECT_EQ(Timeline(&none).due(1), nullptr);
  EXPECT_EQ(Timeline(nullptr).due(1), nullptr);
}

}  // namespace
}  // namespace limber::test_load_scenario
