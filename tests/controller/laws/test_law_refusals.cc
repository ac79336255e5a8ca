// What a law, an arm or a setting cannot do is refused, with the reason, before it runs.
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "common/config_error.h"
#include "controller/laws/registry.h"
#include "robots/loader/default_gains.h"
#include "tests/controller/rig.h"

namespace limber::test_law_refusals {
namespace {

using limber::testing::Rig;
using Message = compliance_gains_t;

struct Refusal {
  const char* name;
  const char* law;
  const char* reason;
  void (*spoil)(Message*);
};

const Refusal kRefusals[] = {
    {"PdPlusHasItsCoriolis", "pd_plus", "model_compensation: pd_plus has its own Coriolis torque",
     [](Message* g) { g->model_compensation = Message::COMPENSATION_GRAVITY_CORIOLIS; }},
    {"JointInertiaWithAHole", "joint_impedance", "M_q_kgm2 must be positive for every joint",
     [](Message* g) {
       set_parameter("M_q_kgm2", {0.0F, 0.0F, 0.3F, 0.0F, 0.0F, 0.0F, 0.0F}, g);
     }},
    {"TipInertiaWithAHole", "opspace_impedance", "M_x must be positive definite in the rows",
     [](Message* g) { g->M_x[0][0] = 2.0F; }},
    {"TipInertiaIndefinite", "opspace_impedance", "M_x must be positive definite in the rows",
     [](Message* g) {
       for (int i = 0; i < 6; ++i) g->M_x[i][i] = 1.0F;
       g->M_x[0][1] = g->M_x[1][0] = 2.0F;
     }},
    {"TipInertiaInGoalAxes", "opspace_impedance", "in the whole block",
     [](Message* g) {
       g->frame = Message::FRAME_GOAL;
       for (int i = 1; i < 6; ++i) g->K_x[i][i] = 0.0;
       g->M_x[0][0] = 2.0F;
     }},
    {"NoTipSensor", "cartesian_impedance", "contact: the arm has no force sensor at the tip",
     [](Message* g) { g->contact = Message::CONTACT_TIP_SENSOR; }},
    {"NoTorqueSensor", "joint_pd", "friction_compensation: the observer needs joint torque sensors",
     [](Message* g) { g->friction_compensation = Message::FRICTION_OBSERVER; }},
    {"DampingNotSymmetric", "", "D_x is not symmetric", [](Message* g) { g->D_x[0][1] = 1.0F; }},
    {"DampingIndefinite", "", "D_x is not positive semidefinite",
     [](Message* g) { g->D_x[3][4] = g->D_x[4][3] = 1.0F; }},
    {"DampingNegative", "", "D_x: the diagonal must be within",
     [](Message* g) { g->D_x[2][2] = -1.0F; }},
    {"DampingNan", "", "D_x is not finite",
     [](Message* g) { g->D_x[2][1] = std::numeric_limits<float>::quiet_NaN(); }},
    {"InertiaNotSymmetric", "accel_feedback", "M_x is not symmetric",
     [](Message* g) { g->M_x[0][1] = 1.0F; }},
    {"InertiaTooMuch", "accel_feedback", "M_x: the diagonal must be within",
     [](Message* g) { g->M_x[5][5] = 101.0F; }},
    {"InertiaCoupledTooMuch", "accel_feedback", "M_x: the diagonal must be within",
     [](Message* g) { g->M_x[0][5] = g->M_x[5][0] = 1e30F; }},
    {"JointDampingTooMuch", "", "D_q_Nms_per_rad must be within",
     [](Message* g) { g->D_q[6] = 1001.0F; }},
    {"JointInertiaNegative", "", "M_q_kgm2 must be within",
     [](Message* g) { set_parameter("M_q_kgm2", std::vector<float>(7, -0.1F), g); }},
    {"StiffnessPerInertia", "", "K_acc_per_s2 must be within",
     [](Message* g) { set_parameter("K_acc_per_s2", std::vector<float>(7, 2e5F), g); }},
    {"Frame", "", "frame must be one of base, goal", [](Message* g) { g->frame = 2; }},
    {"Bias", "", "model_compensation must be one of law_default, none",
     [](Message* g) { g->model_compensation = 4; }},
    {"Damping", "", "damping must be one of double_diagonalisation",
     [](Message* g) { g->damping = -1; }},
    {"JointDamping", "", "joint_damping must be one of double_diagonalisation",
     [](Message* g) { g->joint_damping = 4; }},
    {"Terms", "", "stiffness_terms must be one of first, geometric, full",
     [](Message* g) { g->stiffness_terms = 3; }},
    {"MappingPose", "", "stiffness_pose must be one of current, goal, mid, mean",
     [](Message* g) { set_parameter("stiffness_pose", {4.0F}, g); }},
    {"Partials", "", "damping_partials must be one of none, in_stiffness",
     [](Message* g) { set_parameter("damping_partials", {0.5F}, g); }},
    {"Projector", "", "projector must be one of dynamic, kinematic, none",
     [](Message* g) { g->projector = 3; }},
    {"Contact", "", "contact must be one of none, tip_sensor", [](Message* g) { g->contact = 3; }},
    {"Velocity", "", "velocity must be one of drive, filtered",
     [](Message* g) { g->velocity = 4; }},
    {"Friction", "", "friction_compensation must be one of none, model, observer, dither",
     [](Message* g) { g->friction_compensation = 4; }},
    {"Switch", "", "inertia_feedforward must be one of false, true",
     [](Message* g) { set_parameter("inertia_feedforward", {2.0F}, g); }},
    {"UnknownParameter", "", "no law has a parameter of this name",
     [](Message* g) { set_parameter("stiffnes_pose", {0.0F}, g); }},
    {"ParameterSize", "", "one value a joint",
     [](Message* g) {
       set_parameter("K_acc_per_s2", {1.0F, 2.0F}, g);
     }},
    {"ParameterNan", "", "torque_gain must be within",
     [](Message* g) {
       set_parameter("torque_gain", {std::numeric_limits<float>::quiet_NaN()}, g);
     }},
    {"FrictionShare", "", "friction_share must be within 0..1",
     [](Message* g) { g->friction_share = 1.1F; }},
    {"SpringForce", "", "spring_force_N must be within",
     [](Message* g) { g->spring_force_N = std::numeric_limits<float>::quiet_NaN(); }},
};

class GainsRefusal : public ::testing::TestWithParam<Refusal> {};

TEST_P(GainsRefusal, NamesWhatIsWrong) {
  Rig rig(limber::testing::seven_joint_arm());
  rig.run(0.12);
  Message gains = rig.gains();
  ASSERT_EQ(rig.controller.on_gains(gains), nullptr);
  gains.law = GetParam().law;
  ASSERT_EQ(rig.controller.on_gains(gains), nullptr) << "but for one slip it is taken";
  GetParam().spoil(&gains);
  const char* reason = rig.controller.on_gains(gains);
  ASSERT_NE(reason, nullptr);
  EXPECT_NE(std::string(reason).find(GetParam().reason), std::string::npos) << reason;
}
INSTANTIATE_TEST_SUITE_P(Gains, GainsRefusal, ::testing::ValuesIn(kRefusals),
                         [](const auto& tested) { return std::string(tested.param.name); });

// Six rows of stiffness are more than two joints can move in.
TEST(LawRefusal, TaskWithMoreRowsThanJoints) {
  const LoadedRobot robot = limber::testing::planar_arm(limber::testing::kDesktop);
  Rig rig(robot);
  rig.run(0.12);
  Message gains = rig.gains();
  gains.law = "opspace_impedance";
  EXPECT_NE(rig.controller.on_gains(gains), nullptr);
  for (int i = 2; i < 6; ++i) gains.K_x[i][i] = 0.0;
  EXPECT_EQ(rig.controller.on_gains(gains), nullptr);
}

// What only shows a mistake may run where every bus is simulated, and nowhere else.
TEST(Demonstrations, AreRefusedOnARealBus) {
  LoadedRobot robot = limber::testing::seven_joint_arm();
  robot.robot.buses = {{.name = "arm", .can = "virtual:arm"}};
  for (const bool real : {false, true}) {
    SCOPED_TRACE(real ? "real bus" : "virtual bus");
    if (real) robot.robot.buses.push_back({.name = "hand", .can = "socketcan:can0"});
    ArmController controller(robot, {});
    const auto send = [&](const char* law, const char* key, float value) {
      Message gains = default_gains(robot.robot);
      gains.client = 5;
      gains.law = law;
      if (key != nullptr) set_parameter(key, {value}, &gains);
      return controller.on_gains(gains) == nullptr;
    };
    EXPECT_TRUE(send("mapped_joint_impedance", "damping_partials", 1.0F)) << "in_stiffness";
    EXPECT_EQ(send("mapped_joint_impedance", "damping_partials", 2.0F), !real) << "printed";
    EXPECT_TRUE(send("computed_torque", "literal_stiffness", 0.0F));
    EXPECT_EQ(send("computed_torque", "literal_stiffness", 1.0F), !real);
  }
}

TEST(Demonstrations, ALawIsRefusedOnARealBus) {
  LoadedRobot robot = load_robot("iiwa14");
  ArmControllerOptions options;
  options.law = "deflection_pd";
  EXPECT_NO_THROW(ArmController(robot, options));
  robot.robot.buses.front().can = "socketcan:can0";
  EXPECT_THROW(ArmController(robot, options), ConfigError);
}

TEST(SettingsRefusal, NamesTheSensorThatIsMissing) {
  using namespace controller;
  LawSettings settings = default_settings();
  const unsigned have = sensors::kLinkEncoder | sensors::kMotorEncoder;
  EXPECT_EQ(check_settings(settings, have), nullptr);
  settings.contact = ContactSource::kTipSensor;
  EXPECT_NE(check_settings(settings, have), nullptr);
  EXPECT_EQ(check_settings(settings, have | sensors::kTipForceSensor), nullptr);
  settings.contact = ContactSource::kJointTorque;
  EXPECT_EQ(check_settings(settings, have), nullptr);
  settings.friction_compensation = FrictionCompensation::kObserver;
  EXPECT_NE(check_settings(settings, have), nullptr);
  EXPECT_EQ(check_settings(settings, have | sensors::kTorqueSensor), nullptr);
}

}  // namespace
}  // namespace limber::test_law_refusals
