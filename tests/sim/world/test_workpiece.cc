// Hole and block by hand calculations, and by their energies.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

#include "sim/world/workpiece.h"

namespace limber::sim::test_workpiece {
namespace {

using Eigen::Vector3d;

constexpr double kG = 9.81;
const Vector3d kGravity(0.0, 0.0, -kG);

/// Radius 10 mm, chamfer 2 mm, 20 mm deep, mouth at the origin, the plate below.
Hole plain_hole() {
  Hole hole;
  hole.radius = 0.01;
  hole.chamfer = 0.002;
  hole.depth = 0.02;
  return hole;
}

workpiece_t hole_message() {
  workpiece_t message{};
  message.kind = workpiece_t::KIND_HOLE;
  message.normal[2] = 1.0;
  message.tip_radius_m = 0.008;
  message.stiffness_N_per_m = 1e4;
  message.radius_m = 0.01;
  message.chamfer_m = 0.002;
  message.depth_m = 0.02;
  return message;
}

workpiece_t block_message() {
  workpiece_t message{};
  message.kind = workpiece_t::KIND_BLOCK;
  message.normal[2] = 1.0;
  message.tip_radius_m = 0.01;
  message.stiffness_N_per_m = 1e4;
  message.damping_Ns_per_m = 20.0;
  message.size[0] = 0.1;
  message.size[1] = 0.1;
  message.size[2] = 0.1;
  message.mass_kg = 0.5;
  message.table_friction = 0.4;
  return message;
}

Workpiece made(const workpiece_t& message) {
  Workpiece workpiece;
  EXPECT_TRUE(read_workpiece(message, kGravity, &workpiece));
  return workpiece;
}

TipMotion tip_at(const Vector3d& p, const Vector3d& v = Vector3d::Zero()) {
  return {p, v, Vector3d::Zero(), Eigen::Matrix3d::Identity()};
}

TEST(Hole, FaceChamferBoreAndFloor) {
  const Hole hole = plain_hole();
  const double r = 0.008;
  const auto on_face = hole.touches({0.05, 0.0, 0.007}, r)[0];
  EXPECT_NEAR(on_face.depth, 0.001, 1e-12);
  EXPECT_NEAR(on_face.normal.z(), 1.0, 1e-12);
  // 8 mm from the middle of the chamfer, (11, -1) mm, along its normal, less a millimetre.
  const double out = 0.007 / std::numbers::sqrt2;
  const auto on_chamfer = hole.touches({0.0, 0.011 - out, -0.001 + out}, r)[0];
  EXPECT_NEAR(on_chamfer.depth, 0.001, 1e-12);
  EXPECT_NEAR((on_chamfer.normal - Vector3d(0.0, -1.0, 1.0).normalized()).norm(), 0.0, 1e-9);
  const auto in_bore = hole.touches({-0.003, 0.0, -0.01}, r);
  EXPECT_NEAR(in_bore[0].depth, 0.001, 1e-12);
  EXPECT_NEAR((in_bore[0].normal - Vector3d::UnitX()).norm(), 0.0, 1e-12);
  EXPECT_LT(in_bore[1].depth, 0.0);
  EXPECT_NEAR(hole.touches({0.0, 0.0, -0.013}, r)[1].depth, 0.001, 1e-12) << "the floor";
  EXPECT_LT(hole.touches({0.0, 0.0, -0.01}, r)[0].depth, 0.0) << "in the middle of the bore";
  // Its centre within the plate: out by the nearest way.
  EXPECT_NEAR(hole.touches({0.05, 0.0, -0.001}, r)[0].depth, 0.009, 1e-12);
}

TEST(Hole, ForceIsTheSameRoundItsAxis) {
  Hole hole = plain_hole();
  hole.normal = Vector3d(1.0, 2.0, 2.0) / 3.0;
  hole.mouth = Vector3d(0.3, -0.2, 0.5);
  const Vector3d across = hole.normal.unitOrthogonal();
  for (const double angle : {0.0, 0.7, 2.0, 4.5}) {
    const Vector3d side = Eigen::AngleAxisd(angle, hole.normal) * across;
    const Touch touch = hole.touches(hole.mouth + 0.003 * side - 0.01 * hole.normal, 0.008)[0];
    EXPECT_NEAR(touch.depth, 0.001, 1e-12);
    EXPECT_NEAR((touch.normal + side).norm(), 0.0, 1e-9) << angle;
  }
}

// A ball without friction and damping that falls onto the chamfer: weight and springs are all that
// act, so that energy stays but for the integrator's error.
TEST(Hole, KeepsTheEnergyOfABallThatRollsIn) {
  const Workpiece hole = made(hole_message());
  const double m = 0.1;
  const double h = 1e-6;
  Vector3d p(0.005, 0.0, 0.02);
  Vector3d v = Vector3d::Zero();
  const double start = m * kG * p.z();
  double deepest = 0.0;
  double worst = 0.0;
  for (int i = 0; i < 400'000; ++i) {
    const Vector3d F = hole.wrench(tip_at(p, v)).head<3>() + m * kGravity;
    v += h / m * F;
    p += h * v;
    deepest = std::min(deepest, p.z());
    const bool free = hole.wrench(tip_at(p, v)).isZero(0.0);
    if (free) worst = std::max(worst, std::abs(0.5 * m * v.squaredNorm() + m * kG * p.z() - start));
  }
  EXPECT_LT(deepest, -0.01) << "it is centred by the chamfer, and falls to the floor";
  EXPECT_LT(worst, 1e-3 * m * kG * 0.03);
}

TEST(Hole, TiltedPegTouchesTwice) {
  workpiece_t message = hole_message();
  message.peg[2] = 0.015;  // its other end, above the tip
  const Workpiece hole = made(message);
  const double tilt = 0.5;
  TipMotion tip = tip_at({0.0, 0.0, -0.011});
  tip.R = Eigen::AngleAxisd(tilt, Vector3d::UnitY()).toRotationMatrix();
  // The other end lies 15 mm sin(0.5) = 7.2 mm aside and 2.2 mm over the face: 12 - 7.2 mm from the
  // chamfer's edge, and pushed back: by a moment against the tilt.
  const Vector6 F = hole.wrench(tip);
  EXPECT_LT(F[0], 0.0);
  EXPECT_LT(F[4], 0.0);
}

TEST(Friction, IsCoulombsAndOpposesSliding) {
  ContactMaterial material;
  material.stiffness = 1e4;
  material.friction = 0.3;
  const Touch touch{Vector3d::UnitZ(), 0.001};
  const Vector3d F = material.force(touch, {0.3, -0.4, 0.0});
  EXPECT_NEAR(F.z(), 10.0, 1e-9);
  EXPECT_NEAR(F.x(), -3.0 * 0.6, 1e-9);
  EXPECT_NEAR(F.y(), 3.0 * 0.8, 1e-9);
  EXPECT_NEAR(material.force(touch, {0.0005, 0.0, 0.0}).x(), -1.5, 1e-9) << "a damper at rest";
}

block_truth_t truth_of(const Workpiece& workpiece) {
  block_truth_t truth{};
  workpiece.block()->fill(&truth);
  return truth;
}

TEST(Block, StaysBelowItsFrictionAndSlidesAsNewtonSaysAbove) {
  const double m = 0.5;
  const double mu = 0.4;
  const double h = 1e-4;
  const Vector3d size(0.1, 0.1, 0.1);
  Block block(Vector3d::Zero(), Vector3d::UnitZ(), 0.0, size, m, mu, kGravity);
  for (int i = 0; i < 1000; ++i) block.advance({0.99 * mu * m * kG, 0.0, 0.0}, Vector3d::Zero(), h);
  block_truth_t truth{};
  block.fill(&truth);
  EXPECT_EQ(truth.p_BO[0], 0.0);
  const double F = 3.0;
  for (int i = 0; i < 1000; ++i) block.advance({F, 0.0, 0.0}, Vector3d::Zero(), h);
  block.fill(&truth);
  const double a = F / m - mu * kG;
  EXPECT_NEAR(truth.v_BO[0], a * 0.1, 1e-9);
  EXPECT_NEAR(truth.work_friction_J, mu * m * kG * 0.5 * a * 0.01, 1e-9);
  // Left alone it stops after v^2 / (2 mu g).
  const double start = truth.p_BO[0];
  const double v = truth.v_BO[0];
  for (int i = 0; i < 3000; ++i) block.advance(Vector3d::Zero(), Vector3d::Zero(), h);
  block.fill(&truth);
  EXPECT_EQ(truth.v_BO[0], 0.0);
  EXPECT_NEAR(truth.p_BO[0] - start, v * v / (2.0 * mu * kG), 2.0 * v * h);
}

TEST(Block, PressingFromAboveMakesItHarderToPush) {
  const Vector3d size(0.1, 0.1, 0.1);
  const double limit = 0.4 * (0.5 * kG + 10.0);
  for (const double share : {0.98, 1.02}) {
    Block block(Vector3d::Zero(), Vector3d::UnitZ(), 0.0, size, 0.5, 0.4, kGravity);
    block.advance({share * limit, 0.0, -10.0}, Vector3d::Zero(), 1e-3);
    block_truth_t truth{};
    block.fill(&truth);
    EXPECT_EQ(truth.v_BO[0] > 0.0, share > 1.0);
  }
}

TEST(Block, SpinsDownByItsFriction) {
  // mu m g r on an inertia m r^2: at mu g / r.
  const double r = std::sqrt(0.02 / 12.0);
  Block block(Vector3d::Zero(), Vector3d::UnitZ(), 0.0, {0.1, 0.1, 0.1}, 0.5, 0.4, kGravity);
  const double h = 1e-5;
  // A couple of two forces, as one step each: only the moment is left.
  const auto couple = [&](double F) {
    block.advance({0.0, F, 0.0}, {1.0, 0.0, 0.0}, h);
    block.advance({0.0, -F, 0.0}, {0.0, 0.0, 0.0}, h);
  };
  for (int i = 0; i < 1000; ++i) couple(5.0);
  block_truth_t before{};
  block.fill(&before);
  ASSERT_GT(before.yaw_rate, 1.0);
  for (int i = 0; i < 100; ++i) block.advance(Vector3d::Zero(), Vector3d::Zero(), h);
  block_truth_t after{};
  block.fill(&after);
  const double slid = std::hypot(before.v_BO[0], before.v_BO[1]) / (r * before.yaw_rate);
  EXPECT_LT(slid, 0.01);
  EXPECT_NEAR(before.yaw_rate - after.yaw_rate, 100 * h * 0.4 * kG / r, 1e-3);
}

TEST(Block, EnergiesBalanceWhileABallPushesItAsideAndOn) {
  workpiece_t message = block_message();
  message.friction = 0.3;
  Workpiece workpiece = made(message);
  const double h = 1e-4;
  TipMotion tip = tip_at({-0.06, 0.02, 0.05}, {0.2, 0.0, 0.0});
  double dissipated = 0.0;
  for (int i = 0; i < 10'000; ++i) {
    tip.p += h * tip.v;
    workpiece.advance(tip, h);
    const block_truth_t truth = truth_of(workpiece);
    ASSERT_GE(truth.work_friction_J, dissipated - 1e-15) << "friction gives nothing back";
    dissipated = truth.work_friction_J;
    ASSERT_NEAR(truth.work_contact_J, truth.kinetic_energy_J + truth.work_friction_J, 1e-12);
  }
  const block_truth_t truth = truth_of(workpiece);
  EXPECT_GT(truth.p_BO[0], 0.1);
  EXPECT_LT(truth.yaw, -0.1) << "pushed left of its middle it turns right";
  EXPECT_GT(dissipated, 0.1);
}

TEST(Block, TouchIsOutOfTheNearestFace) {
  Block block({1.0, 2.0, 3.0}, Vector3d::UnitZ(), std::numbers::pi / 2.0, {0.2, 0.1, 0.1}, 1.0, 0.1,
              kGravity);
  // Turned by 90 degrees its long edge lies along y.
  const Touch at_end = block.touch({1.0, 2.105, 3.05}, 0.01);
  EXPECT_NEAR(at_end.depth, 0.005, 1e-12);
  EXPECT_NEAR(at_end.normal.y(), 1.0, 1e-12);
  const Touch inside = block.touch({1.0, 2.0, 3.099}, 0.01);
  EXPECT_NEAR(inside.depth, 0.011, 1e-12);
  EXPECT_NEAR(inside.normal.z(), 1.0, 1e-12);
  EXPECT_GT(block.touch({1.0, 2.0, 3.001}, 0.01).normal.head<2>().norm(), 0.9)
      << "not through the table";
}

TEST(Workpiece, ForceOnArmAndBlockAreOpposite) {
  Workpiece workpiece = made(block_message());
  const TipMotion tip = tip_at({-0.059, 0.0, 0.05});
  const Vector6 F = workpiece.wrench(tip);
  EXPECT_NEAR(F[0], -10.0, 1e-9);
  workpiece.advance(tip, 1e-4);
  EXPECT_NEAR(truth_of(workpiece).F_contact[0], 10.0, 1e-9);
}

TEST(Workpiece, HarderThanTheStepCarriesIsSoftened) {
  Workpiece workpiece = made(block_message());
  const TipMotion tip = tip_at({-0.059, 0.0, 0.05});
  workpiece.limit_to(1.0 / 0.5, 0.01);  // and a block of 0.5 kg, turning: 2 + 8 1/kg
  EXPECT_NEAR(workpiece.wrench(tip)[0], -1.0 / (1e-4 * 10.0) * 1e-3, 1e-9);
}

TEST(Workpiece, WrongOnesAreRefusedWhole) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Workpiece workpiece = made(block_message());
  const auto refused = [&](workpiece_t message, auto change) {
    change(&message);
    EXPECT_FALSE(read_workpiece(message, kGravity, &workpiece));
    EXPECT_NE(workpiece.block(), nullptr) << "unchanged";
  };
  refused(hole_message(), [](workpiece_t* m) { m->radius_m = m->tip_radius_m; });
  refused(hole_message(), [](workpiece_t* m) { m->chamfer_m = 0.03; });
  refused(hole_message(), [&](workpiece_t* m) { m->point[1] = nan; });
  refused(hole_message(), [&](workpiece_t* m) { m->peg[2] = nan; });
  refused(hole_message(), [](workpiece_t* m) { m->normal[2] = 0.5; });
  refused(hole_message(), [](workpiece_t* m) { m->kind = 7; });
  refused(block_message(), [](workpiece_t* m) { m->mass_kg = 0.0; });
  refused(block_message(), [&](workpiece_t* m) { m->yaw = nan; });
  refused(block_message(), [](workpiece_t* m) { m->friction = -0.1; });
  workpiece_t none{};
  EXPECT_TRUE(read_workpiece(none, kGravity, &workpiece));
  EXPECT_FALSE(workpiece.there());
}

}  // namespace
}  // namespace limber::sim::test_workpiece
