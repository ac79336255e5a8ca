// The terms against KDL's solvers, on the arms as they are shipped and on random chains.
#include <gtest/gtest.h>

#include <kdl/chaindynparam.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl/chainjnttojacdotsolver.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "common/config_error.h"
#include "tests/controller/arms.h"

namespace limber::controller::test_kernel {
namespace {

constexpr double kTolerance = 1e-12;  // relative to the largest entry seen on the arm

/// What KDL says at one state, in the words of ArmTerms.
class Oracle {
 public:
  explicit Oracle(const LoadedRobot& robot)
      : chain_(robot.chain),
        n_(chain_.getNrOfJoints()),
        g_(robot.robot.gravity[0], robot.robot.gravity[1], robot.robot.gravity[2]),
        position_(chain_),
        jacobian_(chain_),
        jacobian_rate_(chain_),
        dynamics_(chain_, g_),
        newton_euler_(chain_, g_),
        no_wrench_(chain_.getNrOfSegments(), KDL::Wrench::Zero()) {}

  ArmTerms at(const VectorJ& q, const VectorJ& v) {
    ArmTerms terms(static_cast<int>(n_));
    const KDL::JntArrayVel qv(array(q), array(v));
    KDL::Frame X;
    EXPECT_EQ(position_.JntToCart(qv.q, X), 0);
    terms.X_BT.p << X.p.x(), X.p.y(), X.p.z();
    X.M.GetQuaternion(terms.X_BT.Q.x(), terms.X_BT.Q.y(), terms.X_BT.Q.z(), terms.X_BT.Q.w());
    KDL::Jacobian J(n_);
    EXPECT_EQ(jacobian_.JntToJac(qv.q, J), 0);
    terms.J = J.data;
    terms.V_BT = terms.J * v;
    KDL::Twist rate;
    EXPECT_EQ(jacobian_rate_.JntToJacDot(qv, rate), 0);
    for (int i = 0; i < 6; ++i) terms.Jdot_v[i] = rate[i];
    KDL::JntSpaceInertiaMatrix M(n_);
    EXPECT_EQ(dynamics_.JntToMass(qv.q, M), 0);
    terms.M = M.data;
    KDL::JntArray torque(n_);
    EXPECT_EQ(dynamics_.JntToCoriolis(qv.q, qv.qdot, torque), 0);
    terms.Cv = torque.data;
    EXPECT_EQ(dynamics_.JntToGravity(qv.q, torque), 0);
    terms.g = torque.data;
    return terms;
  }

  VectorJ inverse_dynamics(const VectorJ& q, const VectorJ& v, const VectorJ& a) {
    KDL::JntArray torque(n_);
    EXPECT_EQ(newton_euler_.CartToJnt(array(q), array(v), array(a), no_wrench_, torque), 0);
    return torque.data;
  }

 private:
  KDL::JntArray array(const VectorJ& x) const {
    KDL::JntArray result(n_);
    result.data = x;
    return result;
  }

  KDL::Chain chain_;
  unsigned n_;
  KDL::Vector g_;
  KDL::ChainFkSolverPos_recursive position_;
  KDL::ChainJntToJacSolver jacobian_;
  KDL::ChainJntToJacDotSolver jacobian_rate_;
  KDL::ChainDynParam dynamics_;
  KDL::ChainIdSolver_RNE newton_euler_;
  KDL::Wrenches no_wrench_;
};

/// Largest difference and largest value of one term over many states.
struct Gap {
  template <typename A, typename B>
  void add(const A& ours, const B& theirs) {
    ASSERT_TRUE(ours.allFinite());
    most = std::max(most, (ours - theirs).cwiseAbs().maxCoeff());
    largest = std::max(largest, theirs.cwiseAbs().maxCoeff());
  }
  double most = 0.0;
  double largest = 0.0;
};

void compare(const LoadedRobot& robot, int states, std::mt19937& generator) {
  const int n = robot.robot.size();
  ArmModel model(robot);
  ArmTerms ours(n);
  Oracle oracle(robot);
  Gap p, Q, J, Jdot_v, M, Minv_JT, Cv, g, tau;
  for (int i = 0; i < states; ++i) {
    const VectorJ q = limber::testing::random_vector(n, 3.1, generator);
    const VectorJ v = limber::testing::random_vector(n, 3.0, generator);
    const VectorJ a = limber::testing::random_vector(n, 10.0, generator);
    const ArmTerms theirs = oracle.at(q, v);
    model.evaluate(q, v, &ours);
    p.add(ours.X_BT.p, theirs.X_BT.p);
    Q.add(ours.X_BT.Q.coeffs(), theirs.X_BT.Q.coeffs());
    J.add(ours.J, theirs.J);
    Jdot_v.add(ours.Jdot_v, theirs.Jdot_v);
    M.add(ours.M, theirs.M);
    Minv_JT.add(ours.M_total * ours.Minv_JT, theirs.J.transpose());
    Cv.add(ours.Cv, theirs.Cv);
    g.add(ours.g, theirs.g);
    const VectorJ B_a = model.rotor_inertia().cwiseProduct(a);
    tau.add(model.inverse_dynamics(q, v, a), oracle.inverse_dynamics(q, v, a) + B_a);
  }
  Cv.largest = tau.largest;  // one joint has no Coriolis torque
  const std::pair<const char*, const Gap&> terms[] = {
      {"p", p},   {"Q", Q}, {"J", J},    {"Jdot v", Jdot_v}, {"M", M}, {"Minv_JT", Minv_JT},
      {"Cv", Cv}, {"g", g}, {"tau", tau}};
  for (const auto& [name, gap] : terms) {
    EXPECT_LE(gap.most, kTolerance * gap.largest)
        << robot.robot.name << ", " << n << " joints: " << name;
  }
}

TEST(Kernel, AgreesWithKdlOnShippedArms) {
  std::mt19937 generator(21);
  for (const char* name : {"antagonist2r", "antagonist7", "baxter", "desktop2r", "ideal7", "iiwa14",
                           "openarm", "panda", "planar2r", "testbench"}) {
    compare(load_robot(name), 10'000, generator);
  }
}

// Random chains have fixed and massless segments, tilted bases and gravity in no particular
// direction.
TEST(Kernel, AgreesWithKdlOnRandomChains) {
  std::mt19937 generator(22);
  for (int n = 1; n <= kMaxJoints; ++n) {
    for (const bool prismatic : {false, true}) {
      compare(limber::testing::random_arm(n, static_cast<unsigned>(300 + n), prismatic), 400,
              generator);
    }
  }
}

// All joint types KDL has, and an offset of the joint's zero.
TEST(Kernel, TakesEveryTypeOfJoint) {
  std::mt19937 generator(23);
  KDL::Chain chain;
  const KDL::RigidBodyInertia body(1.0, KDL::Vector(0.1, 0.2, -0.1),
                                   KDL::RotationalInertia(0.02, 0.03, 0.04, 0.001, 0.002, 0.003));
  const KDL::Frame tip(KDL::Rotation::RPY(0.3, -0.4, 0.5), KDL::Vector(0.1, 0.05, 0.3));
  for (const auto type : {KDL::Joint::RotX, KDL::Joint::TransY, KDL::Joint::RotY,
                          KDL::Joint::TransX, KDL::Joint::RotZ, KDL::Joint::TransZ}) {
    chain.addSegment(KDL::Segment(KDL::Joint("j", type, 1.0, 0.4), tip, body));
  }
  // An axis against z, whose frame is turned by half a turn.
  chain.addSegment(KDL::Segment(
      KDL::Joint("j", KDL::Vector(0.1, 0, 0), KDL::Vector(0, 0, -1), KDL::Joint::RotAxis), tip,
      body));
  compare(limber::testing::with_drives(chain, {1.0, 2.0, -9.0}), 1000, generator);
}

TEST(Kernel, RefusesJointsWithScaleOrInertia) {
  const double gravity[3] = {0, 0, -9.81};
  for (const KDL::Joint& joint :
       {KDL::Joint("j", KDL::Joint::RotZ, 2.0), KDL::Joint("j", KDL::Joint::TransX, -1.0),
        KDL::Joint("j", KDL::Joint::RotZ, 1.0, 0.0, 0.1)}) {
    KDL::Chain chain;
    chain.addSegment(KDL::Segment(joint, KDL::Frame::Identity()));
    EXPECT_THROW(ArmModel(chain, gravity, {0.0}), ConfigError);
  }
}

// Against differences of g, which has a potential.
TEST(Kernel, GravityGradientIsTheDerivativeOfGravity) {
  std::mt19937 generator(24);
  constexpr double h = 1e-5;
  for (const int n : {1, 3, 7, 16}) {
    ArmModel model(limber::testing::random_arm(n, 31, true));
    const VectorJ q = limber::testing::random_vector(n, 1.0, generator);
    const MatrixJ slope = model.gravity_gradient(q);
    for (int i = 0; i < n; ++i) {
      const VectorJ step = h * VectorJ::Unit(n, i);
      const VectorJ column = (model.gravity(q + step) - model.gravity(q - step)) / (2.0 * h);
      EXPECT_LT((slope.col(i) - column).norm(), 1e-8 * (1.0 + slope.norm())) << n << " joints";
    }
    ArmTerms terms(n);
    model.evaluate(q, q, &terms);
    EXPECT_LT((terms.g_slope - slope.diagonal()).norm(), 1e-12 * (1.0 + slope.norm()));
  }
}

}  // namespace
}  // namespace limber::controller::test_kernel
