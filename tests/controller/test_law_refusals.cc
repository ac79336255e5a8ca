// What a law, an arm or a setting cannot do is refused, with the reason, before it runs.
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "controller/laws/registry.h"
#include "tests/controller/rig.h"

namespace limber {
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
    {"PdPlusHasItsCoriolis", "pd_plus", "bias: pd_plus has its own Coriolis torque",
     [](Message* g) { g->bias = Message::BIAS_GRAVITY_CORIOLIS; }},
    {"JointInertiaWithAHole", "joint_impedance", "M_q must be positive for every joint",
     [](Message* g) { g->M_q[2] = 0.3F; }},
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
    {"NoTorqueSensor", "joint_pd", "friction: the observer needs joint torque sensors",
     [](Message* g) { g->friction = Message::FRICTION_OBSERVER; }},
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
    {"InertiaCoupledTooMuch", "accel_feedback", "M_x must be within",
     [](Message* g) { g->M_x[0][5] = g->M_x[5][0] = 1e30F; }},
    {"JointDampingTooMuch", "", "D_q must be within", [](Message* g) { g->D_q[6] = 1001.0F; }},
    {"JointInertiaNegative", "", "M_q must be within", [](Message* g) { g->M_q[0] = -0.1F; }},
    {"StiffnessPerInertia", "", "K_acc must be within", [](Message* g) { g->K_acc[0] = 2e5F; }},
    {"Frame", "", "frame must be one of FRAME_*", [](Message* g) { g->frame = 2; }},
    {"Bias", "", "bias must be one of BIAS_*", [](Message* g) { g->bias = 4; }},
    {"Damping", "", "damping must be one of DAMPING_*", [](Message* g) { g->damping = -1; }},
    {"JointDamping", "", "joint_damping must be one of DAMPING_*",
     [](Message* g) { g->joint_damping = 4; }},
    {"Terms", "", "stiffness_terms must be one of STIFFNESS_*",
     [](Message* g) { g->stiffness_terms = 3; }},
    {"StiffnessPose", "", "stiffness_pose must be one of POSE_*",
     [](Message* g) { g->stiffness_pose = 4; }},
    {"Partials", "", "damping_partials must be one of PARTIALS_*",
     [](Message* g) { g->damping_partials = 3; }},
    {"Projector", "", "projector must be one of PROJECTOR_*", [](Message* g) { g->projector = 3; }},
    {"Contact", "", "contact must be one of CONTACT_*", [](Message* g) { g->contact = 3; }},
    {"Velocity", "", "velocity must be one of VELOCITY_*", [](Message* g) { g->velocity = 4; }},
    {"Friction", "", "friction must be one of FRICTION_*", [](Message* g) { g->friction = 3; }},
    {"Switch", "", "inertia_feedforward must be 0 or 1",
     [](Message* g) { g->inertia_feedforward = 2; }},
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

TEST(SettingsRefusal, NamesTheSensorThatIsMissing) {
  using namespace controller;
  LawSettings settings;
  const unsigned have = sensors::kLinkEncoder | sensors::kMotorEncoder;
  EXPECT_EQ(refuse_settings(settings, have), nullptr);
  settings.contact = ContactSource::kTipSensor;
  EXPECT_NE(refuse_settings(settings, have), nullptr);
  EXPECT_EQ(refuse_settings(settings, have | sensors::kTipForceSensor), nullptr);
  settings.contact = ContactSource::kJointTorque;
  EXPECT_EQ(refuse_settings(settings, have), nullptr);
  settings.friction = FrictionCompensation::kObserver;
  EXPECT_NE(refuse_settings(settings, have), nullptr);
  EXPECT_EQ(refuse_settings(settings, have | sensors::kTorqueSensor), nullptr);
}

}  // namespace
}  // namespace limber
