// What holds for every law there is, at random arms, poses, gains and settings.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <string>

#include "controller/impedance/chosen_damping.h"
#include "controller/output/joint_limits.h"
#include "tests/controller/law_bench.h"
#include "tools/allocations/allocations.h"

namespace limber::controller::test_every_law {
namespace {

using limber::testing::LawBench;
using limber::testing::random_arm;
using limber::testing::random_six;
using limber::testing::random_stiffness;
using limber::testing::random_vector;

template <typename Choice>
Choice pick(int count, std::mt19937& generator) {
  return static_cast<Choice>(std::uniform_int_distribution<int>(0, count - 1)(generator));
}

LawSettings random_settings(std::mt19937& generator) {
  LawSettings s = default_settings();
  s.orientation = pick<Orientation>(5, generator);
  s.model_compensation = pick<ModelCompensation>(4, generator);
  s.damping = pick<DampingDesign>(4, generator);
  s.joint_damping = pick<DampingDesign>(4, generator);
  s.stiffness_terms = pick<StiffnessTerms>(3, generator);
  s.contact = pick<ContactSource>(3, generator);
  s.projector = pick<Projector>(3, generator);
  return s;
}

// Stiffness with rows left out, or none at all.
Matrix6 random_task(std::mt19937& generator) {
  Matrix6 K = random_stiffness(800.0, 30.0, generator);
  for (int i = 0; i < 6; ++i) {
    if (pick<int>(4, generator) > 0) continue;
    K.row(i).setZero();
    K.col(i).setZero();
  }
  return pick<int>(10, generator) == 0 ? Matrix6::Zero() : K;
}

VectorJ random_diagonal(int n, double size, std::mt19937& generator) {
  return random_vector(n, size, generator).cwiseMax(0.0);
}

void randomise(LawBench* bench, std::mt19937& generator) {
  const int n = bench->model.size();
  Gains& gains = bench->gains;
  gains.settings = random_settings(generator);
  gains.K_x = random_task(generator);
  gains.D_x = random_stiffness(30.0, 1.0, generator);
  if (pick<int>(2, generator) == 1) gains.M_x = random_stiffness(2.0, 0.1, generator);
  gains.K_q.diagonal() = random_diagonal(n, 100.0, generator);
  gains.D_q.diagonal() = random_diagonal(n, 5.0, generator);
  // Whatever a law declares, within what it declares.
  for (const GainRow* row : law_catalog().parameters) {
    if (row->is_choice()) {
      gains.parameters.set(*row, pick<int>(static_cast<int>(row->words.size()), generator));
    } else if (!row->per_joint) {
      gains.parameters.set(*row, row->low + 0.3 * pick<int>(4, generator));
    } else if (row->key == std::string("M_q_kgm2")) {
      const double inertia = pick<int>(2, generator) == 1 ? 0.3 : 0.0;
      gains.parameters.set(*row, MatrixJ(inertia * MatrixJ::Identity(n, n)));
    } else {
      gains.parameters.set(*row, MatrixJ(random_diagonal(n, 100.0, generator).asDiagonal()));
    }
  }
  bench->goal.V_BD = random_six(0.5, generator);
  bench->goal.A_BD = random_six(1.0, generator);
  bench->goal.F_ff = random_six(10.0, generator);
  bench->goal.v_d = random_vector(n, 0.5, generator);
  bench->goal.a_d = random_vector(n, 1.0, generator);
  bench->estimates.tau_ext = random_vector(n, 3.0, generator);
  bench->estimates.F_ext = random_six(5.0, generator);
  bench->estimates.A_BT = random_six(3.0, generator);
}

// With the springs and motors that the law needs.
LoadedRobot suited(LoadedRobot arm, const std::string& law) {
  const unsigned needs = laws()[static_cast<std::size_t>(find_law(law))].needs;
  for (JointConfig& joint : arm.robot.joints) {
    if ((needs & sensors::kElasticJoints) != 0) {
      joint.transmission.kind = TransmissionKind::kElastic;
      joint.transmission.spring.stiffness_Nm_per_rad = 600.0;
    } else if ((needs & sensors::kTwoMotors) != 0) {
      joint.transmission.kind = TransmissionKind::kAntagonistic;
      joint.transmission.spring = {.law = SpringLaw::kQuadratic, .k2_Nm_per_rad2 = 400.0};
      joint.transmission.preload_rad = 0.3;
      joint.transmission.preload_max_rad = 0.6;
      joint.has_antagonist = true;
      joint.drive.peak_torque_Nm = 80.0;
      joint.antagonist = joint.drive;
    }
  }
  return arm;
}

class EveryLaw : public ::testing::TestWithParam<const char*> {
 protected:
  // Calls `check` with a bench for arms of 1 to 16 joints, gains and settings the law takes.
  template <typename Check>
  void for_random_benches(int times, Check check) {
    std::mt19937 generator(17);
    int checked = 0;
    for (int i = 0; i < times; ++i) {
      const int n = 1 + i % 16;
      SCOPED_TRACE(std::string(GetParam()) + ", case " + std::to_string(i));
      LawBench bench(suited(random_arm(n, static_cast<unsigned>(i), i % 3 == 0), GetParam()),
                     GetParam());
      randomise(&bench, generator);
      if (std::string(GetParam()) != "tomei" && bench.check() != nullptr) continue;
      const VectorJ q = random_vector(n, 2.0, generator);
      bench.set_goal(q + random_vector(n, 0.5, generator));
      check(&bench, q, random_vector(n, 1.0, generator));
      ++checked;
    }
    EXPECT_GT(checked, times / 8);
  }
};

TEST_P(EveryLaw, IsFiniteAndWithinLimitsAndDoesNotAllocate) {
  for_random_benches(160, [](LawBench* bench, const VectorJ& q, const VectorJ& v) {
    bench->model.evaluate(q, v, &bench->terms);
    const auto before = limber::allocations();
    bench->start(q, v);
    VectorJ tau = bench->composed(q, v);
    EXPECT_EQ(limber::allocations(), before);
    ASSERT_TRUE(tau.allFinite());
    EXPECT_TRUE(bench->output.F.allFinite());
    EXPECT_TRUE(std::isfinite(bench->output.spring_energy_J));
    JointLimits limits(bench->robot.robot);
    limits.clamp(1e-3, &tau);
    EXPECT_LE(tau.cwiseAbs().maxCoeff(), 0.8 + 1e-12) << "the gate's step from zero";
    for (int i = 0; i < 100; ++i) {
      tau = bench->output.tau();
      limits.clamp(1e-3, &tau);
    }
    EXPECT_LE((tau.cwiseAbs() - limits.torque_limit()).maxCoeff(), 1e-12);
  });
}

// A quaternion and its negative are one orientation; half a turn away nothing is infinite.
TEST_P(EveryLaw, TakesEveryOrientation) {
  for_random_benches(64, [](LawBench* bench, const VectorJ& q, const VectorJ& v) {
    bench->start(q, v);
    const VectorJ tau = bench->composed(q, v);
    bench->goal.X_BD.Q.coeffs() *= -1.0;
    bench->start(q, v);
    EXPECT_LT((bench->composed(q, v) - tau).norm(), 1e-9 * (1.0 + tau.norm()));
    const Eigen::AngleAxisd half_a_turn(std::numbers::pi, Eigen::Vector3d(1, -2, 3).normalized());
    bench->goal.X_BD.Q = half_a_turn * bench->terms.X_BT.Q;
    bench->start(q, v);
    EXPECT_TRUE(bench->composed(q, v).allFinite());
  });
}

// Through the stretched arm, where the tip cannot move one way.
TEST_P(EveryLaw, IsFiniteAtSingularPoses) {
  LawBench bench(suited(limber::testing::seven_joint_arm(), GetParam()), GetParam());
  bench.gains.settings.contact = ContactSource::kJointTorque;
  for (const bool shaped : {false, true}) {
    if (shaped) bench.gains.M_x.diagonal() << 2.0, 2.0, 2.0, 0.1, 0.1, 0.1;
    for (const double bend : {0.1, 1e-3, 1e-6, 1e-9, 0.0}) {
      const VectorJ q = VectorJ::Constant(7, bend);
      bench.set_goal(q + VectorJ::Constant(7, 0.05));
      bench.start(q, VectorJ::Ones(7));
      const VectorJ tau = bench.composed(q, VectorJ::Ones(7));
      ASSERT_TRUE(tau.allFinite()) << bend;
      EXPECT_LT(tau.norm(), 1e5) << bend;
    }
  }
}

std::vector<const char*> all_laws() {
  std::vector<const char*> names;
  for (const LawEntry& entry : laws()) names.push_back(entry.name);
  return names;
}
INSTANTIATE_TEST_SUITE_P(Registry, EveryLaw, ::testing::ValuesIn(all_laws()),
                         [](const auto& law) { return std::string(law.param); });

template <typename Matrix>
void expect_damper(const Matrix& D) {
  ASSERT_TRUE(D.allFinite());
  EXPECT_LE((D - D.transpose()).norm(), 1e-9 * (1e-9 + D.norm()));
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(D);
  EXPECT_GE(eigen.eigenvalues().minCoeff(), -1e-9 * (1e-9 + D.norm()));
}

TEST(ChosenDamping, IsADamperForEveryDesign) {
  std::mt19937 generator(5);
  for (int i = 0; i < 320; ++i) {
    const int n = 1 + i % 16;
    SCOPED_TRACE("case " + std::to_string(i));
    LawBench bench(random_arm(n, static_cast<unsigned>(i), i % 3 == 0), "joint_pd");
    randomise(&bench, generator);
    bench.start(random_vector(n, 2.0, generator), VectorJ::Zero(n));
    expect_damper(chosen_tip_damping(bench.gains, bench.terms));
    expect_damper(chosen_joint_damping(bench.gains, bench.terms.M_total, bench.gains.K_q));
    const MatrixJ mapped = bench.terms.J.transpose() * bench.gains.K_x * bench.terms.J;
    expect_damper(chosen_joint_damping(bench.gains, bench.terms.M_total, mapped));
  }
}

struct Passive {
  const char* law;
  DampingDesign design;
  Orientation orientation;
};

class Passivity : public ::testing::TestWithParam<Passive> {};

// Kinetic plus spring energy never rises by itself, in continuous time, from wild starts.
TEST_P(Passivity, EnergyNeverRises) {
  std::mt19937 generator(6);
  const LoadedRobot robot = random_arm(6, 2, true);
  LawBench bench(robot, GetParam().law);
  bench.gains.settings.damping = bench.gains.settings.joint_damping = GetParam().design;
  bench.gains.settings.orientation = GetParam().orientation;
  bench.gains.K_x = random_stiffness(300.0, 15.0, generator);
  bench.gains.D_x = random_stiffness(15.0, 0.5, generator);
  bench.gains.D_q.diagonal().setConstant(1.0);
  const VectorJ q_d = random_vector(6, 0.8, generator);
  bench.set_goal(q_d);
  limber::testing::Plant plant(robot);
  plant.q = q_d + random_vector(6, 0.4, generator);
  plant.v = random_vector(6, 0.7, generator);
  bench.start(plant.q, plant.v);
  const auto energy = [&] {
    return plant.kinetic_energy() + bench.at(plant.q, plant.v).spring_energy_J;
  };
  const double start = energy();
  double last = start;
  for (int i = 0; i < 600; ++i) {
    plant.advance(5e-4,
                  [&](const VectorJ& q, const VectorJ& v) { return bench.with_gravity(q, v); });
    const double now = energy();
    ASSERT_LE(now, last + 1e-8 * start) << "step " << i;
    last = now;
  }
  EXPECT_LT(last, 0.9 * start);
}

std::vector<Passive> passive_laws() {
  std::vector<Passive> all;
  for (const auto design : {DampingDesign::kDoubleDiagonalisation, DampingDesign::kFactorisation,
                            DampingDesign::kGiven, DampingDesign::kWithoutInertia}) {
    for (const auto orientation : {Orientation::kLog, Orientation::kQuat}) {
      all.push_back({"cartesian_impedance", design, orientation});
    }
    for (const char* law : {"joint_pd", "pd_plus", "congruence_stiffness"}) {
      all.push_back({law, design, Orientation::kLog});
    }
  }
  return all;
}
INSTANTIATE_TEST_SUITE_P(Springs, Passivity, ::testing::ValuesIn(passive_laws()),
                         [](const auto& tested) {
                           return std::string(tested.param.law) + "_" +
                                  std::to_string(static_cast<int>(tested.param.design)) + "_" +
                                  std::to_string(static_cast<int>(tested.param.orientation));
                         });

}  // namespace
}  // namespace limber::controller::test_every_law
