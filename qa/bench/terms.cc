// What single terms cost that a law may need: what a slower evaluation of them would save.
// `limber lecture experiment run E06` puts them beside the whole cycle.
#include <benchmark/benchmark.h>

#include "controller/impedance/stiffness_mapping.h"
#include "controller/model/arm_terms.h"
#include "robots/loader/load_robot.h"

namespace {

using namespace limber;
using controller::ArmModel;

/// An arm a little off its home, where nothing is zero.
struct Case {
  LoadedRobot robot = load_robot("openarm");
  ArmModel model{robot};
  VectorJ q = VectorJ::Constant(model.size(), 0.3);
  VectorJ v = VectorJ::Constant(model.size(), 0.1);
};

void term_jacobian(benchmark::State& run) {
  Case arm;
  for (auto _ : run) benchmark::DoNotOptimize(arm.model.jacobian(arm.q));
}
BENCHMARK(term_jacobian);

void term_inertia(benchmark::State& run) {
  Case arm;
  for (auto _ : run) benchmark::DoNotOptimize(arm.model.mass(arm.q));
}
BENCHMARK(term_inertia);

/// One pass of recursive Newton-Euler: what Eq. 9 costs.
void term_inverse_dynamics(benchmark::State& run) {
  Case arm;
  for (auto _ : run) benchmark::DoNotOptimize(arm.model.inverse_dynamics(arm.q, arm.v, arm.v));
}
BENCHMARK(term_inverse_dynamics);

/// All of Eq. 4, by differences.
void term_stiffness(benchmark::State& run) {
  Case arm;
  const Matrix6 K_x = 1000.0 * Matrix6::Identity();
  const controller::Pose goal = arm.model.tip_pose(arm.q + arm.v);
  for (auto _ : run) {
    benchmark::DoNotOptimize(
        controller::full_tangent(&arm.model, arm.q, goal, K_x, controller::Orientation::kLog));
  }
}
BENCHMARK(term_stiffness);

}  // namespace
