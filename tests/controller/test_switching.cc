// From every law to every other, between kinds of goals and through every setting: the torque goes
// on where it was, and no limit had to hide a jump.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "controller/gains/read_gains.h"
#include "controller/laws/registry.h"
#include "tests/controller/rig.h"

namespace limber::test_switching {
namespace {

using controller::GoalType;
using limber::testing::Rig;
using Gains = compliance_gains_t;
using Goal = compliance_goal_t;
using Status = controller_status_t;

// with_drives(): what the gate lets pass in a cycle.
constexpr double kGateStep = 1.0;
// Elbow and wrist bent: the laws that need the tip's inertia are no laws for singular poses.
constexpr double kHome[] = {0.4, 0.6, 0.2, -1.2, 0.3, -0.5, 1.5};
constexpr int kClamped = int{Status::LIMIT_RATE} | int{Status::LIMIT_TORQUE};

const controller::LawEntry& entry(const std::string& law) {
  return controller::laws()[static_cast<std::size_t>(controller::find_law(law))];
}

class Switching : public ::testing::Test {
 protected:
  explicit Switching(const LoadedRobot& robot = limber::testing::seven_joint_arm())
      : rig(robot, "joint_pd") {
    rig.plant.q = Eigen::Map<const Eigen::VectorXd>(kHome, 7);
    if (rig.elastic) rig.elastic->rest_at(rig.plant.q);
    rig.to_active();
  }

  // Of the laws this arm can run.
  std::vector<std::string> names() const {
    std::vector<std::string> able;
    for (const controller::LawEntry& law : controller::laws()) {
      if (check_law(law, controller::sensors_of(rig.robot.robot)) == nullptr) {
        able.emplace_back(law.name);
      }
    }
    return able;
  }

  void push(double size) { rig.plant.F_ext << 3.0 * size, -2.0, 1.5 * size, 0.1, 0.0, 0.05; }

  void walk_all_pairs();

  // The first torque after a change, and all that follow.
  void expect_smooth(const std::string& what, double seconds) {
    SCOPED_TRACE(what);
    const VectorJ before = rig.tau();
    rig.clear_jumps();
    rig.step();
    EXPECT_LT((rig.tau() - before).cwiseAbs().maxCoeff(), 0.1 * kGateStep);
    rig.run(seconds);
    EXPECT_EQ(rig.mode(), +Status::MODE_ACTIVE);
    EXPECT_EQ(rig.limits() & kClamped, 0);
  }

  // The robot's, with the contact that an admittance needs.
  Gains gains_of(const std::string& law) const {
    Gains gains = rig.gains();
    gains.law = law;
    if (law == "deflection_pd")
      gains.model_compensation = Gains::COMPENSATION_GRAVITY;  // it carries nothing
    if (law == "admittance") gains.contact = Gains::CONTACT_JOINT_TORQUE;
    return gains;
  }

  void switch_to(const std::string& law) {
    const Gains gains = gains_of(law);
    const char* refused = rig.controller.on_gains(gains);
    ASSERT_EQ(refused, nullptr) << law << ": " << refused;
  }

  // What a law that floats, and all those goals, have moved the arm by.
  void go_home() {
    switch_to("joint_pd");
    Goal goal = rig.goal();
    goal.kind = Goal::GOAL_JOINT;
    std::copy_n(kHome, 7, goal.q);
    goal.duration_s = 0.3;
    ASSERT_EQ(rig.controller.on_goal(goal), nullptr);
    rig.run(0.5);
  }

  // A goal of the kind the law follows, on its way for a while.
  void move_goal(const std::string& law, bool at_tip) {
    if (entry(law).goal_type == GoalType::kNone) return;
    Goal goal = rig.goal();
    sign = -sign;
    if (at_tip || !follows_joints(entry(law).goal_type)) {
      goal.offset[1] = 0.02 * sign;
      goal.offset[5] = 0.1 * sign;
    } else {
      goal.kind = Goal::GOAL_JOINT;
      for (int i = 0; i < 7; ++i) goal.q[i] = rig.state.q[i] + 0.05 * sign;
    }
    goal.duration_s = 0.3;
    const char* refused = rig.controller.on_goal(goal);
    ASSERT_EQ(refused, nullptr) << law << ": " << refused;
  }

  Rig rig;
  double sign = 1.0;
};

// A walk that takes every ordered pair once: there and back for each pair of laws.
class ElasticSwitching : public Switching {
 protected:
  ElasticSwitching() : Switching(limber::testing::elastic_arm(true)) {}
};
class AntagonisticSwitching : public Switching {
 protected:
  AntagonisticSwitching() : Switching(limber::testing::antagonistic_arm()) {}
};

TEST_F(Switching, LawsNeverJump) { walk_all_pairs(); }
TEST_F(ElasticSwitching, LawsNeverJump) { walk_all_pairs(); }
TEST_F(AntagonisticSwitching, LawsNeverJump) { walk_all_pairs(); }

void Switching::walk_all_pairs() {
  bool at_tip = true;
  for (const std::string& from : names()) {
    for (const std::string& to : names()) {
      if (to <= from) continue;
      go_home();
      switch_to(from);
      rig.run(0.55);
      for (const auto& [law, next] : {std::pair{from, to}, std::pair{to, from}}) {
        at_tip = !at_tip;
        move_goal(law, at_tip);
        rig.run(0.05);
        push(at_tip ? 1.0 : -1.0);
        rig.run(0.05);
        rig.plant.F_ext.setZero();  // one of the laws floats
        switch_to(next);
        expect_smooth(law + " -> " + next, 0.4);
        EXPECT_EQ(rig.controller.status().law, controller::find_law(next));
      }
    }
  }
}

// From joints to tip and back under every law for the joints, in the middle of a motion.
TEST_F(Switching, KindsOfGoalsNeverJump) {
  for (const std::string& law : names()) {
    if (!follows_joints(entry(law).goal_type)) continue;
    switch_to(law);
    push(1.0);
    rig.run(0.6);
    for (const bool at_tip : {true, false, true, true, false, false}) {
      move_goal(law, at_tip);
      expect_smooth(law + (at_tip ? ", tip" : ", joints"), 0.2);
    }
    Goal wrench = rig.goal();
    wrench.kind = Goal::GOAL_WRENCH;
    ASSERT_EQ(rig.controller.on_goal(wrench), nullptr);
    expect_smooth(law + ", wrench", 0.2);
  }
}

struct Change {
  const char* name;
  void (*make)(Gains*);
};

const Change kChanges[] = {
    {"quat", [](Gains* g) { g->orientation = Gains::ORIENTATION_QUAT; }},
    {"log_simple", [](Gains* g) { g->orientation = Gains::ORIENTATION_LOG_SIMPLE; }},
    {"quat_simple", [](Gains* g) { g->orientation = Gains::ORIENTATION_QUAT_SIMPLE; }},
    {"goal axes", [](Gains* g) { g->frame = Gains::FRAME_GOAL; }},
    {"gravity", [](Gains* g) { g->model_compensation = Gains::COMPENSATION_GRAVITY; }},
    {"gravity and Coriolis",
     [](Gains* g) { g->model_compensation = Gains::COMPENSATION_GRAVITY_CORIOLIS; }},
    {"factorisation",
     [](Gains* g) { g->damping = g->joint_damping = Gains::DAMPING_FACTORISATION; }},
    {"without inertia",
     [](Gains* g) { g->damping = g->joint_damping = Gains::DAMPING_WITHOUT_INERTIA; }},
    {"damping given",
     [](Gains* g) {
       g->damping = g->joint_damping = Gains::DAMPING_GIVEN;
       g->ramp_s = 5.0;
       for (int i = 0; i < 6; ++i) g->D_x[i][i] = i < 3 ? 15.0F : 0.5F;
       for (float& D : g->D_q) D = 1.0F;
     }},
    {"first term", [](Gains* g) { g->stiffness_terms = Gains::STIFFNESS_FIRST; }},
    {"geometric term", [](Gains* g) { g->stiffness_terms = Gains::STIFFNESS_GEOMETRIC; }},
    {"present pose", [](Gains* g) { set_parameter("stiffness_pose", {0.0F}, g); }},
    {"goal pose", [](Gains* g) { set_parameter("stiffness_pose", {1.0F}, g); }},
    {"mean of poses", [](Gains* g) { set_parameter("stiffness_pose", {3.0F}, g); }},
    {"partials", [](Gains* g) { set_parameter("damping_partials", {1.0F}, g); }},
    {"kinematic projector", [](Gains* g) { g->projector = Gains::PROJECTOR_KINEMATIC; }},
    {"no projector", [](Gains* g) { g->projector = Gains::PROJECTOR_NONE; }},
    {"contact from the joints", [](Gains* g) { g->contact = Gains::CONTACT_JOINT_TORQUE; }},
    {"inertia fed forward", [](Gains* g) { set_parameter("inertia_feedforward", {1.0F}, g); }},
    {"velocity not followed", [](Gains* g) { set_parameter("follow_velocity", {0.0F}, g); }},
    {"spring bounds",
     [](Gains* g) {
       g->spring_force_N = 1.0F;
       g->spring_moment_Nm = 0.1F;
     }},
    {"wanted inertia",
     [](Gains* g) {
       for (int i = 0; i < 6; ++i)
         g->M_x[i][i] = i < 3 ? 1.0F : 0.005F;  // what acceleration feedback bears
       set_parameter("M_q_kgm2", std::vector<float>(7, 0.2F), g);
       g->ramp_s = 0.3;
     }},
    {"periods",
     [](Gains* g) {
       for (std::int16_t& period : g->period_cycles) period = 3;
     }},
};

// There and back, while the arm is pushed away from its goal.
TEST_F(Switching, SettingsNeverJump) {
  const controller::ArmModel model(rig.robot);
  for (const std::string& law : names()) {
    if (entry(law).goal_type == GoalType::kNone) continue;  // and knows no gains
    switch_to(law);
    push(1.0);
    rig.run(0.6);
    for (const Change& change : kChanges) {
      Gains gains = gains_of(law);
      change.make(&gains);
      controller::Gains parsed(7, controller::law_catalog().parameters);
      read_gains(gains, &parsed);
      if (entry(law).make({rig.robot.robot, model})->check(parsed) != nullptr) continue;
      ASSERT_EQ(rig.controller.on_gains(gains), nullptr) << law << ", " << change.name;
      expect_smooth(law + ", " + change.name, 0.1);
      switch_to(law);  // the defaults again
      expect_smooth(law + ", no longer " + change.name, 0.1);
    }
  }
}

}  // namespace
}  // namespace limber::test_switching
