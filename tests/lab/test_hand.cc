// A hand from the request to the fingers and back, over the bus, with drives of every family.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "controller/laws/registry.h"
#include "drivers/protocols/mit.h"
#include "lab/lab.h"
#include "tests/support/mutation.h"
#include "tests/support/source_path.h"
#include "tools/allocations/allocations.h"

namespace limber::test_hand {
namespace {

using testing::Mutation;

/// A shipped arm that gets a hand: motor and gains of holding differ between families.
struct Family {
  const char* name;
  const char* robot;
  const char* motor;
  const char* hold;
};
const Family kFamilies[] = {
    {"damiao_mit", "desktop2r",
     "  grip:\n    protocol: damiao_mit\n    gear_ratio: 10\n    rotor_inertia_kgm2: 1.8e-5\n"
     "    rotor_torque_constant_Nm_per_A: 0.0945\n    phase_resistance_ohm: 0.85\n"
     "    peak_torque_Nm: 7\n    encoder_bits: 14\n    mit_range: {position_rad: 12.5, "
     "velocity_rad_per_s: 30, torque_Nm: 10, kp_Nm_per_rad: 500, kd_Nms_per_rad: 5}\n",
     "  reply_id: 24\n"},
    {"moteus", "planar2r",
     "  grip:\n    protocol: moteus\n    gear_ratio: 10\n    rotor_inertia_kgm2: 1.8e-5\n"
     "    rotor_torque_constant_Nm_per_A: 0.0945\n    phase_resistance_ohm: 0.85\n"
     "    peak_torque_Nm: 7\n    timeout_torque_Nm: 2\n    encoder_bits: 14\n"
     "    pid_position: {kp_Nm_per_turn: 100, kd_Nms_per_turn: 10}\n",
     ""},
    {"cia402", "testbench",
     "  grip:\n    protocol: cia402\n    gear_ratio: 10\n    rotor_inertia_kgm2: 1.8e-5\n"
     "    rotor_torque_constant_Nm_per_A: 0.0945\n    phase_resistance_ohm: 0.85\n"
     "    peak_torque_Nm: 7\n    rated_torque_Nm: 3\n    encoder_bits: 16\n",
     ""},
    {"cubemars", "desktop2r_ak",
     "  grip:\n    protocol: cubemars\n    board: V2\n    model: AK60-6\n    gear_ratio: 10\n"
     "    rotor_inertia_kgm2: 1.8e-5\n    rotor_torque_constant_Nm_per_A: 0.0945\n"
     "    phase_resistance_ohm: 0.85\n    peak_torque_Nm: 7\n",
     ""},
    {"robstride", "planar2r",
     "  grip:\n    protocol: robstride\n    model: RS00\n    gear_ratio: 10\n"
     "    rotor_inertia_kgm2: 1.8e-5\n    rotor_torque_constant_Nm_per_A: 0.0945\n"
     "    phase_resistance_ohm: 0.85\n    peak_torque_Nm: 7\n",
     ""},
    {"myactuator", "axol",
     "  grip:\n    protocol: myactuator\n    firmware: V4.4\n    model: X6\n    gear_ratio: 10\n"
     "    rotor_inertia_kgm2: 1.8e-5\n    rotor_torque_constant_Nm_per_A: 0.0945\n"
     "    phase_resistance_ohm: 0.85\n    peak_torque_Nm: 7\n",
     ""},
};

std::string hand_yaml(const Family& family) {
  return std::string("hand:\n  motor: grip\n  bus: arm\n  id: 8\n") + family.hold +
         "  travel: {width_m: [0, 0.04, 0.088], angle_rad: [0, -0.5, -1.0]}\n"
         "  stiffness_N_per_m: 3000\n  damping_Ns_per_m: 60\n  force_limit_N: 60\n"
         "  hold_force_N: 25\n  speed_limit_m_per_s: 0.25\n  velocity_limit_rad_per_s: 12\n"
         "  continuous_torque_Nm: 3\n  heat_time_constant_s: 30\n  finger_mass_kg: 0.036\n"
         "  friction: {coulomb_Nm: 0.05, viscous_Nms_per_rad: 0.08}\n"
         "  hold: {kp_Nm_per_rad: 10, kd_Nms_per_rad: 0.5}\n";
}

const char* const kHard =
    "objects:\n  - {name: hard, position_m: [0, 0, 0], width_m: 0.05, stiffness_N_per_m: 200000, "
    "damping_Ns_per_m: 100, mass_kg: 0.01, friction: 0.5}\n";

class HandStage {
 public:
  explicit HandStage(const Family& family, const LabOptions& options = {})
      : robot(load(family)), scenario(load_scenario(write_scenario(), robot, nullptr)) {
    // It lies where the tip is at home, whatever the arm.
    lab.emplace(robot, scenario, options);
    const sim_truth_t& truth = lab->truth();
    std::copy_n(truth.p_BT, 3, scenario.objects[0].p_B);
    lab.emplace(robot, scenario, options);
  }

  void run_to(double time_s) {
    while (lab->time_ns() < std::llround(time_s * 1e9)) step();
  }
  void step() {
    lab->step();
    const joint_command_t& answer = lab->torque();
    const double limit = robot.robot.hand->drive.torque_rate_limit_Nm_per_s / robot.robot.rate_hz;
    const auto i = static_cast<std::size_t>(index());
    if (lab->state().drive_state == joint_state_t::DRIVE_ON)
      largest_step = std::max(largest_step, std::abs(answer.tau[i] - last_tau) / limit);
    last_tau = answer.tau[i];
  }
  Refusal ask(double width_m, double force_N, std::int64_t client = kScenarioClient) {
    hand_goal_t goal{};
    goal.client = client;
    goal.width_m = width_m;
    goal.force_N = force_N;
    return lab->controller().on_hand(goal);
  }
  int index() const { return robot.robot.size(); }
  const hand_state_t& state() { return *lab->controller().hand_state(); }
  const hand_truth_t& truth() { return *lab->simulator().hand_truth(); }
  int mode() { return lab->controller_status().mode; }

  LoadedRobot load(const Family& family) {
    const std::string from = source_path("robots/") + family.robot + "/";
    folder.write("robot.urdf", testing::read_text(from + "robot.urdf"));
    const Mutation motor = {"", "\njoints:", "\n" + std::string(family.motor) + "joints:", ""};
    folder.write("robot.yaml", testing::apply(testing::read_text(from + "robot.yaml"), motor).text +
                                   hand_yaml(family));
    return load_robot(folder.path());
  }
  std::string write_scenario() {
    return folder.write("scenario.yaml", "format: limber-scenario/1\nrobot: " + folder.path() +
                                             "/\nduration_s: 700\n" + kHard);
  }

  testing::TemporaryFolder folder;
  LoadedRobot robot;
  Scenario scenario;
  std::optional<Lab> lab;
  double largest_step = 0.0;
  double last_tau = 0.0;
};

class EveryFamily : public ::testing::TestWithParam<int> {
 protected:
  const Family& family() const { return kFamilies[static_cast<std::size_t>(GetParam())]; }
};

TEST_P(EveryFamily, GraspsAndHoldsThroughStopAndHold) {
  HandStage stage(family());
  stage.run_to(1.0);
  ASSERT_EQ(stage.mode(), +controller_status_t::MODE_ACTIVE);
  EXPECT_NE(stage.lab->state().joint_flags[stage.index()] & joint_state_t::JOINT_HAND, 0);
  EXPECT_EQ(stage.lab->state().num_joints, stage.index());
  EXPECT_EQ(stage.ask(-0.01, 40.0), nullptr);
  stage.run_to(2.5);
  EXPECT_EQ(stage.state().grasped, 1);
  const double friction_N = 0.05 / 0.08;
  EXPECT_NEAR(stage.truth().force_N, 25.0, 1.05 * friction_N + 0.3);
  EXPECT_EQ(stage.truth().held, 0);
  mode_request_t stop{};
  stop.request = mode_request_t::REQUEST_STOP;
  stop.client = kScenarioClient;
  EXPECT_EQ(stage.lab->controller().on_mode(stop), nullptr);
  for (const double time_s : {2.6, 2.9, 3.5}) {
    stage.run_to(time_s);
    EXPECT_NEAR(stage.truth().force_N, 25.0, 1.05 * friction_N + 0.3) << time_s;
  }
  EXPECT_EQ(stage.mode(), +controller_status_t::MODE_HOLD);
  EXPECT_EQ(stage.state().grasped, 1);
  EXPECT_LE(stage.largest_step, 1.0);
  EXPECT_EQ(stage.lab->state().fault, +joint_state_t::FAULT_NONE);
}

TEST_P(EveryFamily, KeepsItsGripWithoutTheController) {
  bool gone = false;
  LabOptions options;
  options.before_gate = [&](const joint_command_t& answer, std::vector<joint_command_t>* instead) {
    if (!gone) instead->push_back(answer);
  };
  HandStage stage(family(), options);
  stage.run_to(1.0);
  stage.ask(-0.01, 40.0);
  stage.run_to(2.5);
  ASSERT_EQ(stage.state().grasped, 1);
  gone = true;
  stage.run_to(5.0);
  EXPECT_EQ(stage.lab->state().drive_state, +joint_state_t::DRIVE_HOLD);
  EXPECT_EQ(stage.lab->state().fault, +joint_state_t::FAULT_CONTROLLER_LOST);
  EXPECT_NEAR(stage.truth().force_N, 25.0, 2.0);
  EXPECT_EQ(stage.truth().held, 0);
}

TEST_P(EveryFamily, SilentDriveOfTheHandIsAFaultAtTheHand) {
  HandStage stage(family());
  stage.run_to(1.0);
  scenario_event_t fault{};
  fault.kind = scenario_event_t::EVENT_FAULT;
  fault.joint = stage.index();
  fault.fault = scenario_event_t::FAULT_SILENT;
  fault.normal[2] = 1.0;
  ASSERT_TRUE(stage.lab->simulator().event(fault));
  stage.run_to(1.1);
  EXPECT_EQ(stage.lab->state().fault, +joint_state_t::FAULT_REPLY_LOST);
  EXPECT_EQ(stage.lab->state().fault_joint, stage.index());
  EXPECT_EQ(stage.robot.robot.driven_names()[static_cast<std::size_t>(stage.index())], "hand");
  EXPECT_NE(stage.mode(), +controller_status_t::MODE_ACTIVE);
}

TEST_P(EveryFamily, CycleAllocatesNothing) {
  HandStage stage(family());
  stage.run_to(1.0);
  stage.ask(-0.01, 40.0);
  const std::int64_t before = allocations();
  stage.run_to(2.0);
  EXPECT_EQ(allocations() - before, 0);
}

INSTANTIATE_TEST_SUITE_P(Drives, EveryFamily,
                         ::testing::Range(0, static_cast<int>(std::size(kFamilies))),
                         [](const auto& family) { return kFamilies[family.param].name; });

TEST(Hand, HoldsAHardThingForTenMinutesWithinItsMotorsRating) {
  HandStage stage(kFamilies[0]);
  stage.run_to(1.0);
  // As hard as it may, and grasped again every 20 s, so that the heat is the highest there is.
  double hottest = 0.0;
  double heat = 0.0;
  double most_N = 0.0;
  for (int i = 0; i < 30; ++i) {
    stage.ask(0.088, 0.0);
    stage.run_to(1.5 + 20.0 * i);
    stage.ask(-0.01, 60.0);
    while (stage.lab->time_ns() < std::llround((21.0 + 20.0 * i) * 1e9)) {
      stage.step();
      const double tau = stage.lab->torque().tau[stage.index()];
      const double ratio = tau / 3.0;
      heat += (ratio * ratio - heat) * 1e-3 / 30.0;  // by the standard's first-order model
      hottest = std::max(hottest, heat);
      most_N = std::max(most_N, stage.truth().force_N);
    }
  }
  EXPECT_LE(hottest, 1.0);
  EXPECT_LE(most_N, 60.0 + 8.0) << "the impact of the moving mass is the object's";
  EXPECT_EQ(stage.lab->state().fault, +joint_state_t::FAULT_NONE);
  EXPECT_NEAR(stage.truth().force_N, 25.0, 1.0);
  EXPECT_LE(stage.largest_step, 1.0);
}

TEST(Hand, BytesOnTheBusAreItsTorqueAndItsAngle) {
  HandStage stage(kFamilies[0]);
  const auto ends = stage.lab->attach();
  stage.run_to(1.0);
  stage.ask(0.03, 40.0);
  const DriveConfig& drive = stage.robot.robot.hand->drive.drive;
  int commands = 0;
  int replies = 0;
  CanFrame frame;
  while (ends[0]->receive(std::span(&frame, 1)) == 1) {
  }
  double asked = stage.lab->torque().tau[stage.index()];
  for (int i = 0; i < 500; ++i) {
    stage.step();
    while (ends[0]->receive(std::span(&frame, 1)) == 1) {
      if (frame.id == 8) {
        // Position 16, velocity 12, kp 12, kd 12, torque 12 bits: only the last is not its zero.
        const int raw = (frame.data[6] & 0xF) << 8 | frame.data[7];
        const double torque = raw * 20.0 / 4095.0 - 10.0;
        EXPECT_NEAR(torque, asked, 1.01 * 20.0 / 4095.0);
        ++commands;
      } else if (frame.id == 24 && frame.data[0] >> 4 == 1) {  // enabled; no answer of a register
        const int raw = frame.data[1] << 8 | frame.data[2];
        const double angle = raw * 25.0 / 65535.0 - 12.5;
        EXPECT_NEAR(angle, stage.lab->state().q[stage.index()], 25.0 / 65535.0);
        EXPECT_EQ(frame.id, drive.reply_id);
        ++replies;
      }
    }
    asked = stage.lab->torque().tau[stage.index()];
  }
  EXPECT_EQ(commands, 500);
  EXPECT_GE(replies, 500);
}

TEST(Hand, GateRefusesWhatTheHandMayNot) {
  double add = 0.0;
  LabOptions options;
  int hand = 0;
  options.before_gate = [&](const joint_command_t& answer, std::vector<joint_command_t>* instead) {
    joint_command_t changed = answer;
    changed.tau[hand] += add;
    instead->push_back(changed);
  };
  HandStage stage(kFamilies[0], options);
  hand = stage.index();
  stage.run_to(1.0);
  for (const auto& [torque, verdict] :
       {std::pair{1.0, +driver_status_t::VERDICT_RATE},
        {9.0, +driver_status_t::VERDICT_TORQUE},
        {std::numeric_limits<double>::quiet_NaN(), +driver_status_t::VERDICT_NOT_FINITE}}) {
    add = torque;
    stage.step();
    EXPECT_EQ(stage.lab->verdict(), verdict) << torque;
    add = 0.0;
    stage.run_to(1e-9 * static_cast<double>(stage.lab->time_ns()) + 0.2);
  }
}

TEST(Hand, RefusesGoalsAsTheArmDoes) {
  HandStage stage(kFamilies[0]);
  stage.run_to(0.5);
  EXPECT_EQ(stage.ask(0.03, 10.0).code, +request_answer_t::REFUSED_MODE);
  stage.run_to(1.0);
  EXPECT_EQ(stage.ask(0.03, 10.0, 77).code, +request_answer_t::REFUSED_LEASE);
  EXPECT_EQ(stage.ask(0.2, 10.0).code, +request_answer_t::REFUSED_HAND_LIMIT);
  EXPECT_EQ(stage.ask(-0.03, 10.0).code, +request_answer_t::REFUSED_HAND_LIMIT);
  EXPECT_EQ(stage.ask(0.03, 61.0).code, +request_answer_t::REFUSED_HAND_LIMIT);
  EXPECT_EQ(stage.ask(0.03, -1.0).code, +request_answer_t::REFUSED_HAND_LIMIT);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(stage.ask(nan, 10.0).code, +request_answer_t::REFUSED_MALFORMED);
  EXPECT_EQ(stage.lab->controller_status().requests_refused, 7);
  EXPECT_EQ(stage.ask(0.03, 10.0), nullptr);

  const LoadedRobot bare = load_robot("desktop2r");
  const Scenario scenario;
  Lab lab(bare, scenario);
  hand_goal_t goal{};
  goal.client = 1;
  EXPECT_EQ(lab.controller().on_hand(goal).code, +request_answer_t::REFUSED_NO_HAND);
  EXPECT_EQ(lab.controller().hand_state(), nullptr);
  EXPECT_EQ(lab.simulator().hand_truth(), nullptr);
}

/// Left and right are each other's mirror images: the same scenario, reflected, moves both alike.
TEST(Hand, LeftArmIsTheRightOneReflected) {
  const LoadedRobot right = load_robot("openarm_right");
  const LoadedRobot left = load_robot("openarm_left");
  const Scenario scenario;
  Lab of_right(right, scenario);
  Lab of_left(left, scenario);
  const double sign[] = {-1, -1, -1, 1, -1, -1, -1};
  for (std::size_t i = 0; i < 7; ++i) {
    const JointConfig& r = right.robot.joints[i];
    const JointConfig& l = left.robot.joints[i];
    EXPECT_NEAR(l.home, sign[i] * r.home, 1e-9);
    EXPECT_NEAR(l.position_max, sign[i] > 0 ? r.position_max : -r.position_min, 1e-6) << l.name;
    EXPECT_NEAR(l.position_min, sign[i] > 0 ? r.position_min : -r.position_max, 1e-6) << l.name;
  }
  for (int i = 0; i < 50; ++i) {
    of_right.step();
    of_left.step();
  }
  const sim_truth_t& r = of_right.truth();
  const sim_truth_t& l = of_left.truth();
  EXPECT_NEAR(l.p_BT[0], r.p_BT[0], 1e-6);
  EXPECT_NEAR(l.p_BT[1], -r.p_BT[1], 1e-6);
  EXPECT_NEAR(l.p_BT[2], r.p_BT[2], 1e-6);
  const double quat[] = {1, -1, 1, -1};
  const double turn = l.quat_BT[0] * r.quat_BT[0] > 0 ? 1.0 : -1.0;
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(l.quat_BT[i], turn * quat[i] * r.quat_BT[i], 1e-6);
  for (int i = 0; i < 7; ++i)
    EXPECT_NEAR(of_left.torque().tau_gravity[i], sign[i] * of_right.torque().tau_gravity[i], 1e-2)
        << "but for encoders of 14 bits, which round towards zero on both sides";
}

}  // namespace
}  // namespace limber::test_hand
