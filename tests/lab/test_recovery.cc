// What no arm may fault in, and the way back from what it may.
#include <gtest/gtest.h>

#include <string>

#include "controller/laws/registry.h"
#include "lab/lab.h"
#include "tests/support/mutation.h"

namespace limber::test_recovery {
namespace {

using Status = controller_status_t;

/// The mode at the end of a timeline, and every mode on the way.
struct Course {
  int last;
  std::vector<int> modes;
};

Course run(const std::string& robot_name, double duration_s, const std::string& timeline) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.write(
      "scenario.yaml", "format: limber-scenario/1\nrobot: " + robot_name +
                           "\nmode: lockstep\nduration_s: " + std::to_string(duration_s) +
                           "\nseed: 7\ntimeline:\n" + timeline);
  const LoadedRobot robot = load_robot(robot_name);
  const Scenario scenario = load_scenario(path, robot, &controller::law_catalog());
  Lab lab(robot, scenario);
  Course course{};
  while (lab.time_ns() < static_cast<std::int64_t>(duration_s * 1e9)) {
    lab.step();
    course.last = lab.controller_status().mode;
    if (course.modes.empty() || course.modes.back() != course.last)
      course.modes.push_back(course.last);
  }
  return course;
}

// Friction and wall hold a joint to a single count while the others move on: no broken encoder.
TEST(Recovery, AnArmThatPressesAndSlidesIsSound) {
  for (const char* along : {"0.1, 0, 0", "0.1, 0.05, 0", "0.1, 0, 0.08", "0.08, -0.1, 0"}) {
    const Course course =
        run("openarm", 5.0,
            "  - {at_s: 0.3, mode: hold}\n"
            "  - {at_s: 0.8, mode: active}\n"
            "  - {at_s: 1.0, gains: {law: cartesian_impedance, K_x_translation_N_per_m: 600}}\n"
            "  - {at_s: 1.2, wall: {point_m: [0.29, -0.25, 0.53], normal: [-1, 0, 0],"
            " stiffness_N_per_m: 20000, damping_Ns_per_m: 50}}\n"
            "  - {at_s: 1.9, goal: {offset_m: [" +
                std::string(along) + "], duration_s: 1.5}}\n");
    EXPECT_EQ(course.last, +Status::MODE_ACTIVE) << along;
  }
}

// The cure that docs/troubleshooting.md names for driver.DRIVE_ERROR, a drive of each family.
TEST(Recovery, ADriveThatFailedIsEnabledAgain) {
  for (const auto& [robot, joint] : {std::pair{"openarm", "joint2"},
                                     {"panda", "joint2"},
                                     {"ideal7", "joint_2"},
                                     {"axol", "shoulder_2"},
                                     {"desktop2r_ak", "elbow"},
                                     {"desktop2r_odrive", "elbow"},
                                     {"testbench", "joint"}}) {
    const Course course = run(robot, 10.0,
                              "  - {at_s: 0.3, mode: hold}\n"
                              "  - {at_s: 1.0, mode: active}\n"
                              "  - {at_s: 1.5, fault: {kind: drive_error, joint: " +
                                  std::string(joint) +
                                  ", for_s: 0.5}}\n"
                                  "  - {at_s: 3.0, mode: acknowledge}\n"
                                  "  - {at_s: 3.5, mode: idle}\n"
                                  "  - {at_s: 5.5, mode: hold}\n"
                                  "  - {at_s: 9.0, mode: active}\n");
    EXPECT_NE(std::ranges::find(course.modes, +Status::MODE_FAULT), course.modes.end()) << robot;
    EXPECT_EQ(course.last, +Status::MODE_ACTIVE) << robot;
  }
}

}  // namespace
}  // namespace limber::test_recovery
