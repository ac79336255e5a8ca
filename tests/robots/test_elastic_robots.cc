// The shipped arms whose joints have springs: what the tables and formulas they were made from say.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "robots/loader/load_robot.h"
#include "tests/robots/arm_terms.h"
#include "tests/support/source_path.h"

namespace limber::test_elastic_robots {
namespace {

using testing::Terms;
using testing::terms_at;

constexpr const char* kElastic[] = {"iiwa14", "panda", "baxter", "testbench"};
constexpr const char* kAntagonistic[] = {"antagonist2r", "antagonist7"};

/// Tip, torque of gravity and row sums of the mass matrix as Pinocchio 4.1 computes them from the
/// same URDF; mass as the tables sum it.
struct Independent {
  const char* robot;
  double mass;
  double q[7], p[3], g[7], M_sum[7];
};
const Independent kIndependent[] = {
    {"iiwa14",
     25.61,
     {0.3, -0.7, 0.5, 1.1, -0.4, 0.8, 1.2},
     {-0.6171626994, -0.4224519818, 0.6936589178},
     {0, 57.28627852, 7.131949043, -22.45565308, 0.7720392801, 0.9576544585, 0},
     {4.819707641, 3.82033251, 2.499872807, 0.01273176816, -0.0725395588, 0.07893223921,
      0.003078545819}},
    {"panda",
     16.062132,
     {0.2, -0.5, 0.3, -2.0, -0.4, 1.8, 0.6},
     {0.3678027952, 0.2035367483, 0.6829572701},
     {0, -8.383539196, -3.997463118, 18.24637615, 0.4885544192, 1.559838447, 0.0369326144},
     {1.199521024, 0.3927155032, 1.690611034, 0.2279073791, 0.07177079533, 0.1419823469,
      -0.01332109501}},
    {"baxter",  // the maker's 19.71172 kg without its nine placeholders of 0.1 g
     19.71082,
     {0.3, -0.6, 0.4, 1.1, -0.3, 0.9, 0.5},
     {0.7308338265, 0.4077472735, 0.02081088507},
     {0, -44.6899778, 5.510043741, -11.84928704, 0.2882841816, -0.2952730302, 0.005301201581},
     {4.61911456, 2.895697225, 1.725064807, 1.732193711, 0.2510604894, 0.1018225857,
      0.002496187027}},
    {"antagonist7",
     4.4,
     {0.4, 0.6, -0.3, 1.1, 0.5, -0.4, 0.3},
     {0.4241669598, 0.2176138344, -0.3102318377},
     {5.017583442, 4.2180353, 1.361272909, 1.975347382, -0.09253654273, 0.212394975, 0.08222901335},
     {0.4645157972, 0.421328983, 0.1997031689, 0.119412763, -0.01375895998, 0.02629571622,
      0.01876435355}},
};

double moving_mass(const LoadedRobot& arm) {
  double mass = 0.0;
  for (unsigned i = 0; i < arm.chain.getNrOfSegments(); ++i)
    mass += arm.chain.getSegment(i).getInertia().getMass();
  return mass;
}

TEST(ElasticRobots, MoveAsAnotherLibrarySays) {
  for (const Independent& other : kIndependent) {
    const LoadedRobot arm = load_robot(other.robot);
    ASSERT_EQ(arm.robot.size(), 7) << other.robot;
    const Terms terms = terms_at(arm, std::vector<double>(other.q, other.q + 7));
    const Eigen::VectorXd M_sum = terms.M.rowwise().sum();
    EXPECT_NEAR(moving_mass(arm), other.mass, 1e-9) << other.robot;
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(terms.p_BT[i], other.p[i], 1e-9) << other.robot;
    for (int i = 0; i < 7; ++i) {
      EXPECT_NEAR(terms.g[i], other.g[i], 1e-7) << other.robot << " " << i;
      EXPECT_NEAR(M_sum[i], other.M_sum[i], 1e-8) << other.robot << " " << i;
    }
  }
}

TEST(ElasticRobots, TestbenchIsAPendulumWithRoundFigures) {
  const std::string folder = source_path("robots/testbench/");
  const double gravity[3] = {0.0, -7.0, 0.0};
  const LoadedRobot bench = load_urdf(folder + "robot.urdf", "base", "tip", gravity);
  for (const double q : {0.0, 0.7, -2.0}) {
    EXPECT_NEAR(terms_at(bench, {q}).g[0], 7.0 * std::sin(q), 1e-12) << q;
    EXPECT_NEAR(terms_at(bench, {q}).M(0, 0), 0.5, 1e-12) << q;
  }
  const LoadedRobot held = load_urdf(folder + "held.urdf", "base", "tip", gravity);
  EXPECT_EQ(terms_at(held, {0.7}).M(0, 0), 1e6);
  EXPECT_NEAR(terms_at(held, {0.7}).g[0], 0.0, 1e-12);
  const JointConfig joint = load_robot("testbench").robot.joints[0];
  EXPECT_EQ(joint.drive.rotor_inertia_kgm2, 0.2);
  EXPECT_EQ(joint.transmission.spring.stiffness_Nm_per_rad, 5000.0);
  EXPECT_EQ(joint.transmission.damping_Nms_per_rad, 2.0);
  EXPECT_EQ(joint.drive.actuator.kind, ActuatorKind::kIdeal);
  EXPECT_FALSE(joint.torque_loop.present());
}

TEST(ElasticRobots, MotorsReflectTheInertiaOfTheTables) {
  const struct {
    const char* robot;
    double inertia[7];
  } tables[] = {
      {"iiwa14", {3.38176, 3.38176, 3.38176, 3.38176, 1.321, 1.16224, 1.16224}},
      {"panda",
       {0.605721456, 0.605721456, 0.462474144, 0.462474144, 0.205544064, 0.205544064, 0.205544064}},
      {"baxter", {0.4, 0.4, 0.4, 0.4, 0.08, 0.08, 0.08}},
  };
  for (const auto& table : tables) {
    const Robot robot = load_robot(table.robot).robot;
    for (std::size_t i = 0; i < 7; ++i) {
      EXPECT_NEAR(robot.joints[i].drive.rotor_inertia_kgm2, table.inertia[i], 1e-12)
          << table.robot << " " << i;
      EXPECT_NEAR(robot.joints[i].apparent_rotor_inertia_kgm2(), table.inertia[i] / 4.0, 1e-12);
    }
  }
}

// rho - 1 < d / (K_J (T/2 + t_d)) with the link held: see the comments in their robot.yaml. A third
// of it is left as margin.
TEST(ElasticRobots, TorqueLoopsAreFarFromTheirStabilityLimit) {
  for (const char* name : kElastic) {
    for (const JointConfig& joint : load_robot(name).robot.joints) {
      const double damping =
          joint.transmission.damping_Nms_per_rad + joint.friction.viscous_Nms_per_rad;
      const double delay_s = 0.5 / joint.torque_loop.rate_hz + joint.drive.actuator.lag_s +
                             joint.torque_loop.delay_s + joint.torque_sensor.delay_s +
                             joint.torque_sensor.filter_s;
      const double limit = damping / (joint.transmission.spring.stiffness_Nm_per_rad * delay_s);
      EXPECT_LT(joint.torque_loop.inertia_ratio - 1.0, limit / 1.5) << name << " " << joint.name;
    }
  }
}

TEST(ElasticRobots, ElasticJointsHaveTheirSensorsAndAskLessThanTheSpring) {
  for (const char* name : kElastic) {
    const Robot robot = load_robot(name).robot;
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
      const JointConfig& joint = robot.joints[i];
      EXPECT_EQ(joint.transmission.kind, TransmissionKind::kElastic) << name;
      EXPECT_TRUE(joint.torque_sensor.present && joint.link_encoder.present) << name;
      EXPECT_LT(robot.gains.K_q[i], 0.3 * joint.transmission.spring.stiffness_Nm_per_rad) << name;
    }
  }
}

/// sigma = 2 k2 c of a quadratic pair.
double stiffness(const JointConfig& joint, double preload) {
  return 2.0 * joint.transmission.spring.k2_Nm_per_rad2 * preload;
}

// Torque tau leaves both springs taut only if sigma >= sqrt(2 k2 tau); the motor has to carry the
// spring at full preload and half the joint's torque limit.
TEST(ElasticRobots, AntagonistsCarryTheArm) {
  for (const char* name : kAntagonistic) {
    const LoadedRobot arm = load_robot(name);
    EXPECT_EQ(arm.robot.motors(), 2 * arm.robot.size());
    std::vector<double> home;
    for (const JointConfig& joint : arm.robot.joints) home.push_back(joint.home);
    const Terms terms = terms_at(arm, home);
    for (std::size_t i = 0; i < home.size(); ++i) {
      const JointConfig& joint = arm.robot.joints[i];
      const double k2 = joint.transmission.spring.k2_Nm_per_rad2;
      const double most = joint.transmission.preload_max_rad;
      const double weight = std::abs(terms.g[static_cast<Eigen::Index>(i)]);
      EXPECT_EQ(joint.transmission.kind, TransmissionKind::kAntagonistic) << joint.name;
      EXPECT_GT(stiffness(joint, joint.transmission.preload_rad),
                1.2 * std::sqrt(2.0 * k2 * weight))
          << name << " " << joint.name;
      EXPECT_GT(stiffness(joint, most), std::sqrt(2.0 * k2 * joint.torque_limit_Nm)) << joint.name;
      EXPECT_GT(joint.drive.peak_torque_Nm, 0.5 * k2 * most * most + 0.5 * joint.torque_limit_Nm)
          << joint.name;
      EXPECT_LT(arm.robot.gains.K_q[i], stiffness(joint, joint.transmission.preload_rad));
    }
  }
}

}  // namespace
}  // namespace limber::test_elastic_robots
