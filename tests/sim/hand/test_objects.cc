// What a hand takes, carries and drops.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "robots/loader/load_robot.h"
#include "sim/hand/objects.h"
#include "sim/model/arm_model.h"

namespace limber::sim::test_objects {
namespace {

constexpr double kStep_s = 250e-6;
constexpr double kG = 9.81;

class ObjectsTest : public ::testing::Test {
 protected:
  ObjectsTest() : robot_(load_robot("openarm_right")), arm_(build_arm_model(robot_)) {
    q_.resize(7);
    for (int i = 0; i < 7; ++i) q_[i] = robot_.robot.joints[static_cast<std::size_t>(i)].home;
    pose(0.0);
    const Eigen::Vector3d at = grasp_point();
    object_ = {"thing", {at.x(), at.y(), at.z()}, 0.04, 1e4, 10.0, 0.5, 0.3};
  }
  /// The elbow turned by so much: raises the hand.
  void pose(double turn) {
    VectorJ q = q_;
    q[3] += turn;
    arm_.set_state(q, VectorJ::Zero(7));
  }
  Eigen::Vector3d grasp_point() const {
    const Eigen::Vector3d p_TG(robot_.robot.hand->p_TG);
    return arm_.link_position(arm_.tip()) + arm_.link_rotation(arm_.tip()) * p_TG;
  }
  Objects objects() const { return {{object_}, robot_.robot.hand->p_TG, robot_.robot.gravity}; }
  void run(Objects* objects, double width, double force, double time_s) {
    for (double t = 0.0; t < time_s; t += kStep_s) objects->step(arm_, width, force, kStep_s);
  }
  /// Slowly, to 40 mm higher.
  void lift(Objects* objects, double force) {
    for (turn_ = 0.0; height() < 0.04; turn_ += 1e-5) {
      pose(turn_);
      objects->step(arm_, 0.039, force, kStep_s);
    }
  }
  double height() const { return grasp_point().z() - object_.p_B[2]; }

  LoadedRobot robot_;
  LinkDynamics arm_;
  VectorJ q_;
  double turn_ = 0.0;
  ObjectConfig object_;
};

TEST_F(ObjectsTest, HandsTakeWhatIsInReachAndNarrowerThanTheyAreOpen) {
  Objects open = objects();
  open.step(arm_, 0.05, 0.0, kStep_s);
  EXPECT_EQ(open.between(), 0);
  Objects closed = objects();
  closed.step(arm_, 0.03, 0.0, kStep_s);
  EXPECT_EQ(closed.between(), Objects::kNone);
  object_.p_B[1] += 1.01 * Objects::kReach_m;
  Objects far = objects();
  far.step(arm_, 0.05, 0.0, kStep_s);
  EXPECT_EQ(far.between(), Objects::kNone);
}

TEST_F(ObjectsTest, IsCarriedFromTheWeightOfItsFrictionOn) {
  const double least_N = object_.mass_kg * kG / (2.0 * object_.friction);
  for (const double share : {1.02, 0.98}) {
    pose(0.0);
    Objects thing = objects();
    run(&thing, 0.05, 0.0, 0.01);
    EXPECT_EQ(thing.held_mass_kg(), 0.0);
    lift(&thing, share * least_N);
    if (share > 1.0) {
      EXPECT_EQ(thing.held(), 0);
      EXPECT_DOUBLE_EQ(thing.held_mass_kg(), object_.mass_kg);
      EXPECT_NEAR(thing.position(0).z() - object_.p_B[2], 0.04, 1e-3);
      EXPECT_NEAR((thing.position(0) - grasp_point()).norm(), 0.0, 1e-3);
    } else {
      EXPECT_EQ(thing.held(), Objects::kNone);
      EXPECT_LT(thing.position(0).z() - object_.p_B[2], Objects::kLift_m);
    }
  }
}

TEST_F(ObjectsTest, WhatItLiesOnGivesItToTheArmOverTheFirstWay) {
  Objects thing = objects();
  run(&thing, 0.05, 0.0, 0.01);
  const double half_m = 0.5 * Objects::kLift_m;
  for (turn_ = 0.0; height() < half_m; turn_ += 1e-5) {
    pose(turn_);
    thing.step(arm_, 0.039, 50.0, kStep_s);
  }
  const double lifted = thing.position(0).z() - object_.p_B[2];
  EXPECT_NEAR(thing.held_mass_kg(), object_.mass_kg * lifted / Objects::kLift_m, 1e-9);
}

TEST_F(ObjectsTest, FallsAsThingsDoAndRestsWhereItLay) {
  Objects thing = objects();
  run(&thing, 0.05, 0.0, 0.01);
  lift(&thing, 30.0);
  run(&thing, 0.039, 30.0, 0.1);  // the last move is over
  const double top = thing.position(0).z() - object_.p_B[2];
  double fall_s = 0.0;
  while (!thing.rests(0) && fall_s < 1.0) {
    thing.step(arm_, 0.05, 0.0, kStep_s);
    fall_s += kStep_s;
  }
  EXPECT_NEAR(fall_s, std::sqrt(2.0 * top / kG), 2e-3);
  EXPECT_NEAR(thing.position(0).z(), object_.p_B[2], 2e-3);
  EXPECT_EQ(thing.held_mass_kg(), 0.0);
}

TEST_F(ObjectsTest, SlidesWithWhatFrictionLeavesOfGravity) {
  Objects thing = objects();
  run(&thing, 0.05, 0.0, 0.01);
  lift(&thing, 30.0);
  run(&thing, 0.039, 30.0, 0.1);
  const double before = thing.position(0).z();
  const double half_N = 0.5 * object_.mass_kg * kG / (2.0 * object_.friction);
  run(&thing, 0.039, half_N, 0.06);
  EXPECT_TRUE(thing.slips(0));
  EXPECT_NEAR(before - thing.position(0).z(), 0.25 * kG * 0.06 * 0.06, 3e-4);
}

}  // namespace
}  // namespace limber::sim::test_objects
