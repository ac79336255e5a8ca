// All terms of random chains, by one build of the kernel: included behind arm_kernel.cc,
// geometric_mean.cc and spd_solve.cc, whose namespace `dynamics` the includer renames, and whose
// functions it gives a kind of processor.
#pragma once

#include <random>
#include <vector>

namespace limber::dynamics {

inline BodyChain random_chain(int joints, std::mt19937* random) {
  std::normal_distribution<double> normal;
  const auto vector = [&] { return Vector3d(normal(*random), normal(*random), normal(*random)); };
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
std::vector<double> terms_of_random_chains() {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::vector<double> numbers;
  const auto keep = [&](const auto& matrix) {
    numbers.insert(numbers.end(), matrix.data(), matrix.data() + matrix.size());
  };
  for (int n = 1; n <= 16; ++n) {
    AnyArmKernel any = arm_kernel(random_chain(n, &random), {0.3, -0.2, -9.81});
    VectorJ q(n), v(n), a(n), tau(n), CTv(n), g(n);
    MatrixJ M(n, n);
    Matrix6J J(6, n);
    for (int state = 0; state < 50; ++state) {
      for (VectorJ* vector : {&q, &v, &a})
        for (double& entry : *vector) entry = normal(random);
      std::visit(
          [&](auto& kernel) {
            kernel.place(q);
            kernel.weigh();
            kernel.move(v, a);
            kernel.mass(&M);
            kernel.torque(&tau, &CTv);
            kernel.gravity(&g);
            kernel.jacobian(&J);
          },
          any);
      MatrixJ mean(n, n);
      const MatrixJ spring = v.cwiseAbs().asDiagonal();
      if (!geometric_mean(M, spring, mean)) mean.setZero();
      MatrixJ part(n, n);
      if (!geometric_mean(M, MatrixJ(tau * tau.transpose()), part)) part.setZero();
      MatrixJ6 Minv_JT(n, 6);
      Matrix6 G;
      solve_spd(M, J, &Minv_JT, &G);
      VectorJ Minv_tau = tau;
      solve_spd(M, &Minv_tau);
      G.diagonal().array() += 1e-3;  // of few joints it is singular
      const Matrix6 Lambda = inverse_spd(G);
      keep(M), keep(tau), keep(CTv), keep(g), keep(J), keep(mean), keep(part), keep(Minv_JT),
          keep(Minv_tau);
      keep(G), keep(Lambda);
    }
  }
  return numbers;
}

}  // namespace limber::dynamics
