// Friction feed-forward: the share of Coulomb by the goal's direction and of viscous by the speed.
#include <gtest/gtest.h>

#include "controller/observers/friction_feedforward.h"

namespace limber::controller::test_friction_feedforward {
namespace {

TEST(FrictionFeedforward, ByHand) {
  const VectorJ ones = VectorJ::Ones(4);
  const FrictionFeedforward friction{2.0 * ones, 0.5 * ones, 0.8, 0.01};
  const VectorJ v_d = (VectorJ(4) << 0.3, -0.3, 0.0, 0.005).finished();
  const VectorJ v = (VectorJ(4) << 1.0, -1.0, 0.2, -0.2).finished();
  const VectorJ tau = friction.torque(v_d, v);
  EXPECT_NEAR(tau[0], 0.8 * (2.0 + 0.5), 1e-15);
  EXPECT_NEAR(tau[1], -0.8 * (2.0 + 0.5), 1e-15);
  EXPECT_NEAR(tau[2], 0.8 * 0.1, 1e-15) << "no goal speed, no Coulomb part";
  EXPECT_NEAR(tau[3], 0.8 * (1.0 - 0.1), 1e-15) << "no jump";
}

}  // namespace
}  // namespace limber::controller::test_friction_feedforward
