// Twist and acceleration of a pose motion from rest, by the closed form of minimum jerk.
#include <gtest/gtest.h>

#include "controller/goals/interpolation.h"
#include "controller/model/rotation.h"

namespace limber::controller::test_interpolation {
namespace {

// s = 10 x^3 - 15 x^4 + 6 x^5, x = t / T; the pose is p0 + s d, Exp(s phi) R0, so that the twist is
// s' [d; phi] and the acceleration s'' [d; phi].
TEST(PoseMotion, FromRestHasTheRatesOfMinimumJerk) {
  constexpr double T = 1.6;
  const Pose start{{0.1, -0.4, 0.3}, exp_rotation({0.3, 0.2, -0.8})};
  Vector6 way;
  way << 0.4, 0.1, -0.2, 1.3, -0.7, 1.9;
  const Pose end{start.p + way.head<3>(), exp_rotation(way.tail<3>()) * start.Q};
  for (const double t : {0.0, 0.2, 0.8, 1.1, 1.6}) {
    PoseMotion motion;
    motion.reset(start);
    motion.start(end, T);
    motion.advance(t);
    const double x = t / T;
    const double s = x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
    const double ds = 30.0 * x * x * (1.0 - x) * (1.0 - x) / T;
    const double dds = 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / (T * T);
    EXPECT_LT((motion.X_BD.p - start.p - s * way.head<3>()).norm(), 1e-14) << t;
    const Eigen::Quaterniond turned = motion.X_BD.Q * start.Q.conjugate();
    EXPECT_LT((log_rotation(turned) - s * way.tail<3>()).norm(), 1e-13) << t;
    EXPECT_LT((motion.V_BD - ds * way).norm(), 1e-13) << t;
    EXPECT_LT((motion.A_BD - dds * way).norm(), 1e-12) << t;
  }
}

}  // namespace
}  // namespace limber::controller::test_interpolation
