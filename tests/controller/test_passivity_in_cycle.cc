// What the loop's sampling and its one cycle of delay do to an undamped spring is seen and taken
// back.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/controller/rig.h"

namespace limber::test_passivity_in_cycle {
namespace {

using limber::testing::kSliderMass;
using limber::testing::Rig;
using Gains = compliance_gains_t;

constexpr double kK = 500.0;
constexpr double kT = 1e-3;

// Torque steps that no limit shapes: the observer counts what the law asks for.
LoadedRobot quick_slider() {
  LoadedRobot robot = limber::testing::slider();
  robot.robot.joints[0].torque_rate_limit_Nm_per_s = 1e6;
  return robot;
}

// A slider on an undamped spring at rest, struck.
struct Undamped {
  explicit Undamped(double passivity_damping) : rig(quick_slider()) {
    rig.to_active();
    Gains gains = rig.gains();
    for (auto& row : gains.K_x) std::fill(std::begin(row), std::end(row), 0.0);
    gains.K_x[0][0] = kK;
    gains.damping = Gains::DAMPING_GIVEN;
    gains.passivity_damping_Ns_per_m = static_cast<float>(passivity_damping);
    EXPECT_EQ(rig.controller.on_gains(gains), nullptr);
    rig.run(1.0);  // the gains' ramp is over
    x_0 = rig.plant.q[0];
    rig.plant.v[0] = 0.6;
  }
  double energy_J() const {
    const double x = rig.plant.q[0] - x_0;
    return 0.5 * kSliderMass * rig.plant.v[0] * rig.plant.v[0] + 0.5 * kK * x * x;
  }
  /// Made by the law: what the observer sees besides the spring's own store.
  double made_J() const {
    return rig.controller.status().spring_energy_J - rig.controller.status().passivity_energy_J;
  }

  Rig rig;
  double x_0 = 0.0;
};

// A spring that is held for T after a delay t_d makes K (T/2 + t_d) times the integral of v^2:
// pi K (T/2 + t_d) a^2 w a cycle (Colgate, Schenkel 1997). The chain's delay is one cycle.
TEST(PassivityInCycle, SeesTheEnergyThatSamplingMakes) {
  Undamped loop(0.0);
  const double start = loop.energy_J();
  double v2 = 0.0;
  for (int i = 0; i < 2000; ++i) {
    v2 += kT * loop.rig.plant.v[0] * loop.rig.plant.v[0];
    loop.rig.step();
  }
  const double made = kK * 1.5 * kT * v2;
  EXPECT_NEAR(loop.made_J(), made, 0.02 * made);
  EXPECT_NEAR(loop.energy_J() - start, made, 0.02 * made) << "and the mass has it";
  EXPECT_GT(made, start) << "it has more than doubled";
}

TEST(PassivityInCycle, DampingKeepsTheAmplitude) {
  Undamped loop(60.0);
  const double start = loop.energy_J();
  double most = 0.0;
  for (int i = 0; i < 4000; ++i) {
    loop.rig.step();
    most = std::max(most, loop.energy_J());
  }
  EXPECT_LT(most, 1.1 * start) << "half a cycle's energy is made before it is seen";
  EXPECT_GT(loop.energy_J(), 0.7 * start) << "and no more damping than it takes";
}

}  // namespace
}  // namespace limber::test_passivity_in_cycle
