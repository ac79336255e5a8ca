// A stiffness that rises under load is paid for by the tank, and ends where the tank does.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/controller/rig.h"

namespace limber::test_tank_in_cycle {
namespace {

using limber::testing::Rig;
using Gains = compliance_gains_t;

constexpr double kTank_J = 0.2;

struct Slider {
  Slider() : rig(limber::testing::slider()) { rig.to_active(); }

  Gains gains(double K, double tank_J, double ramp_s) const {
    Gains message = rig.gains();
    for (auto& row : message.K_x) std::fill(std::begin(row), std::end(row), 0.0);
    message.K_x[0][0] = K;
    message.tank_J = static_cast<float>(tank_J);
    message.ramp_s = ramp_s;
    return message;
  }
  void set(double K, double tank_J, double ramp_s) {
    ASSERT_EQ(rig.controller.on_gains(gains(K, tank_J, ramp_s)), nullptr);
  }
  double tank_J() const { return rig.controller.status().tank_energy_J; }
  /// Of the spring in force, while the slider is at rest.
  double stiffness() const {
    return -rig.controller.status().F_law[0] / rig.controller.status().e[0];
  }
  double energy_J() const {
    const controller_status_t& status = rig.controller.status();
    return status.kinetic_energy_J + status.spring_energy_J;
  }
  /// Pulled to F / K and let go.
  void pluck(double F) {
    rig.plant.F_ext[0] = F;
    rig.run(3.0);
    rig.plant.F_ext[0] = 0.0;
  }

  Rig rig;
};

// At rest under F the error is F / K, and raising K costs dE = F^2 / (2 K^2) dK: from K_0 the tank
// carries it to 1 / K = 1 / K_0 - 2 E / F^2. What the damper gives meanwhile is below 1 %.
TEST(TankInCycle, StiffnessStopsWhereTheTankIsEmpty) {
  constexpr double F = 20.0;
  Slider slider;
  slider.set(400.0, kTank_J, 0.0);
  slider.rig.plant.F_ext[0] = F;
  slider.rig.run(3.0);
  ASSERT_NEAR(slider.stiffness(), 400.0, 0.5);
  ASSERT_NEAR(slider.tank_J(), kTank_J, 1e-6) << "full: what the damper gave is not stored";

  slider.set(450.0, kTank_J, 10.0);
  slider.rig.run(11.0);
  const double drawn = 0.5 * F * F * (1.0 / 400.0 - 1.0 / 450.0);
  EXPECT_NEAR(slider.stiffness(), 450.0, 0.5);
  EXPECT_NEAR(slider.tank_J(), kTank_J - drawn, 0.03 * drawn);

  slider.set(2000.0, kTank_J, 10.0);
  slider.rig.run(11.0);
  const double last = 1.0 / (1.0 / 400.0 - 2.0 * kTank_J / (F * F));
  EXPECT_NEAR(slider.stiffness(), last, 0.03 * last);
  EXPECT_LT(slider.tank_J(), 1e-3);
}

TEST(TankInCycle, OtherSettingsLeaveWhatIsInIt) {
  Slider slider;
  slider.set(400.0, kTank_J, 0.0);
  slider.rig.plant.F_ext[0] = 20.0;
  slider.rig.run(3.0);
  slider.set(800.0, kTank_J, 10.0);
  slider.rig.run(11.0);
  const double left = slider.tank_J();
  ASSERT_LT(left, 0.5 * kTank_J);
  Gains other = slider.gains(800.0, kTank_J, 0.0);
  other.orientation = Gains::ORIENTATION_QUAT;
  ASSERT_EQ(slider.rig.controller.on_gains(other), nullptr);
  slider.rig.run(0.1);
  EXPECT_NEAR(slider.tank_J(), left, 1e-6);
}

// The most that energy of mass and spring exceeds that of the start, when the stiffness is told to
// rise and fall at times that nobody has chosen.
double excess(double tank_J) {
  Slider slider;
  slider.set(300.0, tank_J, 0.0);
  slider.pluck(20.0);
  slider.rig.step();
  const double start = slider.energy_J();
  std::mt19937 generator(4);
  std::uniform_real_distribution<double> wait(0.15, 0.4);
  double most = 0.0;
  for (int change = 0; change < 12; ++change) {
    slider.set(change % 2 == 0 ? 3000.0 : 300.0, tank_J, 0.0);
    for (double left = wait(generator); left > 0.0; left -= 1e-3) {
      slider.rig.step();
      most = std::max(most, slider.energy_J() - start);
    }
  }
  return most;
}

TEST(TankInCycle, EnergyStaysBelowStartAndTank) {
  constexpr double kSmall_J = 0.05;
  EXPECT_LE(excess(kSmall_J), kSmall_J);
  EXPECT_GT(excess(0.0), 2.0 * kSmall_J) << "without a tank the demands put this in";
}

}  // namespace
}  // namespace limber::test_tank_in_cycle
