// Masses put together, and what a chain of bodies refuses.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <kdl/chain.hpp>

#include "common/config_error.h"
#include "dynamics/body_chain.h"

namespace limber::dynamics::test_body_chain {
namespace {

TEST(PointMass, TwoPointsTurnAboutTheirMiddle) {
  // 2 kg and 1 kg, 0.3 m apart: the centre divides the distance 1 to 2, and what turns about it is
  // the reduced mass 2/3 kg at 0.3 m.
  const MassProperties first = with_point_mass({}, 2.0, Eigen::Vector3d::Zero());
  const MassProperties both = with_point_mass(first, 1.0, {0.3, 0.0, 0.0});
  EXPECT_DOUBLE_EQ(both.mass, 3.0);
  EXPECT_NEAR(both.com.x(), 0.1, 1e-15);
  const Eigen::Vector3d moments(0.0, 0.06, 0.06);
  EXPECT_LT((both.inertia - Eigen::Matrix3d(moments.asDiagonal())).norm(), 1e-15);
}

TEST(PointMass, NoneIsNothing) {
  const MassProperties body = with_point_mass({}, 2.0, {0.1, 0.2, 0.3});
  const MassProperties same = with_point_mass(body, 0.0, {5.0, 5.0, 5.0});
  EXPECT_EQ(same.mass, body.mass);
  EXPECT_LT((same.com - body.com).norm(), 1e-15);
  EXPECT_LT((same.inertia - body.inertia).norm(), 1e-15);
  EXPECT_EQ(with_point_mass({}, 0.0, {1.0, 0.0, 0.0}).mass, 0.0);
}

TEST(OwnInertia, IsAboutTheJointsAxis) {
  Body body;
  body.mass.mass = 2.0;
  body.mass.com << 0.3, 0.4, 7.0;
  body.mass.inertia = Eigen::Vector3d(1.0, 2.0, 0.25).asDiagonal();
  EXPECT_NEAR(body.own_inertia(), 0.25 + 2.0 * 0.25, 1e-15);
  body.prismatic = true;
  EXPECT_EQ(body.own_inertia(), 2.0);
}

TEST(BodyChain, HasAFrameASegmentAndABodyAJoint) {
  const KDL::RigidBodyInertia kilogram(1.0, KDL::Vector(0.1, 0.0, 0.0));
  KDL::Chain chain;
  chain.addSegment(KDL::Segment("foot", KDL::Joint(KDL::Joint::Fixed),
                                KDL::Frame(KDL::Vector(0.0, 0.0, 0.5)), kilogram));
  chain.addSegment(KDL::Segment("arm", KDL::Joint(KDL::Joint::RotY),
                                KDL::Frame(KDL::Vector(0.2, 0.0, 0.0)), kilogram));
  chain.addSegment(KDL::Segment("hand", KDL::Joint(KDL::Joint::Fixed),
                                KDL::Frame(KDL::Vector(0.1, 0.0, 0.0)), kilogram));
  const BodyChain found = body_chain(chain, 1);
  ASSERT_EQ(found.size(), 1);
  ASSERT_EQ(found.frames.size(), 3U);
  EXPECT_EQ(found.frames[0].body, -1);
  EXPECT_EQ(found.frames[2].body, 0);
  EXPECT_NEAR(found.frames[2].p.norm(), 0.3, 1e-15);
  EXPECT_NEAR(found.bodies[0].p.z(), 0.5, 1e-15);
  EXPECT_LT((found.bodies[0].R.col(2) - Eigen::Vector3d::UnitY()).norm(), 1e-15);
  // Arm and hand, not the foot: 1 kg at 0.3 m and 1 kg at 0.4 m, given at the segments' ends.
  EXPECT_EQ(found.bodies[0].mass.mass, 2.0);
  EXPECT_NEAR(found.bodies[0].mass.com.norm(), 0.35, 1e-15);
  EXPECT_THROW(body_chain(chain, 2), ConfigError);
  EXPECT_THROW(body_chain(KDL::Chain(), 0), ConfigError);
}

}  // namespace
}  // namespace limber::dynamics::test_body_chain
