// An arm in a lab, for the tests of drive families.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "controller/laws/registry.h"
#include "lab/lab.h"
#include "tests/support/mutation.h"

namespace limber::testing {

/// A timeline that ends in ACTIVE.
inline const std::string kActive =
    "  - {at_s: 0.3, mode: hold}\n"
    "  - {at_s: 0.8, mode: active}\n";

/// `robot` as robot.yaml has it, on drives as `real` has them; frictionless.
struct FamilyArm {
  FamilyArm(const LoadedRobot& given, const std::string& timeline,
            const LoadedRobot* real = nullptr, const std::string& integrator = "reference")
      : robot(given),
        path(folder.write("scenario.yaml", "format: limber-scenario/1\nrobot: " + given.robot.name +
                                               "\nmode: lockstep\nduration_s: 20\nseed: 7\n"
                                               "integrator: " +
                                               integrator + "\nfriction: false\ntimeline:\n" +
                                               timeline)),
        scenario(load_scenario(path, robot, &controller::law_catalog())),
        lab(robot, scenario, LabOptions{real, {}, {}}) {}

  void run_to(double time_s) {
    while (lab.time_ns() < static_cast<std::int64_t>(std::llround(time_s * 1e9))) lab.step();
  }
  int mode() const { return lab.controller_status().mode; }

  TemporaryFolder folder;
  LoadedRobot robot;
  std::string path;
  Scenario scenario;
  Lab lab;
};

/// How far the tip of a planar arm of two joints yields to 5 and 3 N at 300 N/m, m; no frame is
/// lost, invalid or foreign meanwhile.
inline std::pair<double, double> yields(const LoadedRobot& robot) {
  FamilyArm arm(robot,
                kActive +
                    "  - {at_s: 1.0, gains: {law: cartesian_impedance, K_x_translation_N_per_m: "
                    "300, K_x_rotation_Nm_per_rad: 0, damping_ratio: 0.7, ramp_s: 0.2}}\n"
                    "  - {at_s: 2.0, push: {force_N: [5, 3, 0], ramp_s: 0.2, for_s: 3}}\n");
  arm.run_to(1.9);
  const sim_truth_t before = arm.lab.truth();
  arm.run_to(4.5);
  EXPECT_EQ(arm.mode(), +controller_status_t::MODE_ACTIVE);
  const driver_status_t& status = arm.lab.driver_status();
  for (int j = 0; j < 2; ++j) {
    EXPECT_EQ(status.replies_lost[j], 0);
    EXPECT_EQ(status.replies_invalid[j], 0);
  }
  EXPECT_EQ(status.frames_foreign[0], 0);
  const sim_truth_t& now = arm.lab.truth();
  return {now.p_BT[0] - before.p_BT[0], now.p_BT[1] - before.p_BT[1]};
}

}  // namespace limber::testing
