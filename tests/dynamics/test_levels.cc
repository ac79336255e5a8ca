// Whatever the width of the processor's registers, the kernel gives the same bits.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <bit>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "common/config_error.h"
#include "dynamics/levels.h"

namespace limber::dynamics::test_levels {
namespace {

BodyChain random_chain(int joints, std::mt19937* random) {
  std::normal_distribution<double> normal;
  const auto vector = [&] {
    return Eigen::Vector3d(normal(*random), normal(*random), normal(*random));
  };
  BodyChain chain;
  for (int i = 0; i < joints; ++i) {
    Body body;
    body.p = vector();
    body.R = Eigen::AngleAxisd(normal(*random), vector().normalized()).toRotationMatrix();
    body.prismatic = normal(*random) > 1.0;
    body.mass.mass = 1.0 + std::abs(normal(*random));
    body.mass.com = vector();
    body.mass.inertia = vector().cwiseAbs().asDiagonal();
    chain.bodies.push_back(body);
  }
  chain.frames.resize(1);
  return chain;
}

/// 50 states of a chain of each length from 1 to 16 joints, all numbers in one row.
std::vector<double> terms_of_random_chains(const Level& level) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::vector<double> numbers;
  const auto keep = [&](const auto& matrix) {
    numbers.insert(numbers.end(), matrix.data(), matrix.data() + matrix.size());
  };
  for (int n = 1; n <= 16; ++n) {
    const auto kernel = level.arm_kernel(random_chain(n, &random), {0.3, -0.2, -9.81});
    VectorJ q(n), v(n), a(n), tau(n), CTv(n), g(n);
    MatrixJ M(n, n);
    Matrix6J J(6, n);
    for (int state = 0; state < 50; ++state) {
      for (VectorJ* vector : {&q, &v, &a})
        for (double& entry : *vector) entry = normal(random);
      kernel->place(q);
      kernel->weigh();
      kernel->move(v, a);
      kernel->mass(&M);
      kernel->torque(&tau, &CTv);
      kernel->gravity(&g, nullptr);
      kernel->jacobian(&J);
      MatrixJ mean(n, n);
      const MatrixJ spring = v.cwiseAbs().asDiagonal();
      if (!level.mean(M, spring, mean)) mean.setZero();
      MatrixJ part(n, n);
      if (!level.mean(M, MatrixJ(tau * tau.transpose()), part)) part.setZero();
      MatrixJ6 Minv_JT(n, 6);
      Matrix6 G;
      level.solve_tip(M, J, &Minv_JT, &G);
      VectorJ Minv_tau = tau;
      level.solve_one(M, &Minv_tau);
      G.diagonal().array() += 1e-3;  // of few joints it is singular
      const Matrix6 Lambda = level.inverse(G);
      keep(M), keep(tau), keep(CTv), keep(g), keep(J), keep(mean), keep(part), keep(Minv_JT),
          keep(Minv_tau);
      keep(G), keep(Lambda);
    }
  }
  return numbers;
}

/// FNV-1a.
std::uint64_t digest(const std::vector<double>& numbers) {
  std::uint64_t sum = 0xcbf29ce484222325;
  for (const double number : numbers)
    sum = (sum ^ std::bit_cast<std::uint64_t>(number)) * 0x100000001b3;
  return sum;
}

TEST(Levels, GiveTheSameBits) {
  const std::vector<double> plain = terms_of_random_chains(named_level("plain"));
  ASSERT_GT(plain.size(), 100'000U);
  // Compared with that of another kind of processor by tests/bare/test_other_processor.py.
  RecordProperty("digest", std::to_string(digest(plain)));
  for (const Level* level : levels()) {
    const std::vector<double> found = terms_of_random_chains(*level);
    ASSERT_EQ(found.size(), plain.size());
    for (std::size_t i = 0; i < plain.size(); ++i) {
      ASSERT_TRUE(std::isfinite(plain[i])) << i;
      ASSERT_EQ(std::bit_cast<std::uint64_t>(found[i]), std::bit_cast<std::uint64_t>(plain[i]))
          << level->name << ", " << i;
    }
  }
}

TEST(Levels, AreThoseOfTheProcessor) {
  EXPECT_STREQ(levels().back()->name, "plain");
#ifdef __x86_64__
  EXPECT_EQ(levels().size(), 1U + (__builtin_cpu_supports("avx2") ? 1 : 0) +
                                 (__builtin_cpu_supports("avx512f") ? 1 : 0));
#endif
  EXPECT_THROW(named_level("avx1024"), ConfigError);
}

// What a vector has room for but no entry is no part of any sum.
TEST(Levels, LanesWithoutAJointDoNotCount) {
  std::mt19937 random(1);
  const BodyChain chain = random_chain(3, &random);
  for (const Level* level : levels()) {
    const auto kernel = level->arm_kernel(chain, {0.0, 0.0, -9.81});
    VectorJ q = VectorJ::Constant(4, std::nan("")), tau(3), CTv(3);
    q.conservativeResize(3);
    q.setConstant(0.3);
    kernel->place(q);
    kernel->weigh();
    kernel->move(q, q);
    kernel->torque(&tau, &CTv);
    EXPECT_TRUE(tau.allFinite() && CTv.allFinite()) << level->name;
  }
}

}  // namespace
}  // namespace limber::dynamics::test_levels
