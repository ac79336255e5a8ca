// A drive family that was added to its lists works everywhere: loader, driver, simulator, decoder,
// DBC, faults. Nothing but the lists knows of it (edits.yaml).
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "common/config_error.h"
#include "controller/laws/registry.h"
#include "drivers/protocols/cycle_frames.h"
#include "lab/lab.h"
#include "qa/faults/families.h"
#include "qa/faults/fault_table.h"
#include "robots/loader/required_keys.h"
#include "scenarios/loader/scenario.h"
#include "tests/support/source_path.h"
#include "tools/can/bus_decoder.h"
#include "tools/can/dbc_messages.h"

namespace limber::test_added_family {
namespace {

namespace fs = std::filesystem;

/// planar2r with other drives.
class AddedFamily : public ::testing::Test {
 protected:
  AddedFamily() : folder_(fs::path(::testing::TempDir()) / "toy2r") {
    const fs::path planar = source_path("robots/planar2r");
    fs::create_directories(folder_);
    fs::copy_file(planar / "robot.urdf", folder_ / "robot.urdf",
                  fs::copy_options::overwrite_existing);
    std::ostringstream text;
    text << std::ifstream(planar / "robot.yaml").rdbuf();
    yaml_ = text.str();
    replace("protocol: moteus", "protocol: toy");
    replace("    timeout_torque_Nm: 50 # a time-out brakes the falling arm\n", "");
    replace("    encoder_bits: 32\n", "");
    const auto gains = yaml_.find("    pid_position:");
    yaml_.replace(gains, yaml_.find('\n', gains) - gains, "    toy_speed_rad_per_s: 20");
  }
  void replace(const std::string& old, const std::string& by) {
    ASSERT_NE(yaml_.find(old), std::string::npos) << old;
    yaml_.replace(yaml_.find(old), old.size(), by);
  }
  LoadedRobot load() const {
    std::ofstream(folder_ / "robot.yaml") << yaml_;
    return load_robot(folder_.string());
  }
  Scenario scenario(const LoadedRobot& robot, const std::string& events) const {
    const std::string file = (folder_.parent_path() / "toy_first.yaml").string();
    std::ofstream(file) << "format: limber-scenario/1\nrobot: toy2r\nmode: lockstep\n"
                           "duration_s: 4\nfriction: false\ntimeline:\n"
                        << events;
    return load_scenario(file, robot, &controller::law_catalog());
  }

  fs::path folder_;
  std::string yaml_;
};

TEST_F(AddedFamily, IsLoadedAndItsKeysAreRequired) {
  const LoadedRobot robot = load();
  EXPECT_EQ(robot.robot.joints[1].drive.command_id, 0x102u);
  EXPECT_NE(required_keys_table().find("`toy_speed_rad_per_s` | of the motor (`toy` only)"),
            std::string::npos);
  replace("    toy_speed_rad_per_s: 20\n", "");
  try {
    load();
    FAIL() << "a required key is missing";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("toy_speed_rad_per_s"), std::string::npos);
  }
}

TEST_F(AddedFamily, HasItsFramesInTheBusLoad) {
  const LoadedRobot robot = load();
  const auto frames = cycle_frames(robot.robot, 0);
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[0].command.length, 24);
  EXPECT_EQ(frames[0].replies.at(0).length, 16);
}

// A push of 10 N against 500 N/m moves the tip by 20 mm.
TEST_F(AddedFamily, MovesAnArm) {
  const LoadedRobot robot = load();
  const Scenario softly = scenario(robot,
                                   "  - {at_s: 0.3, mode: hold}\n"
                                   "  - {at_s: 0.8, mode: active}\n"
                                   "  - {at_s: 2, push: {force_N: [10, 0, 0], for_s: 2}}\n");
  Lab lab(robot, softly);
  const auto ends = lab.attach();
  bus_tools::BusDecoder decoder(robot.robot, 0);
  int commands = 0;
  double before_m = 0.0;
  while (lab.cycles() < 3990) {
    if (lab.cycles() == 1990) before_m = lab.truth().p_BT[0];
    lab.step();
    CanFrame frame;
    while (ends[0]->receive(std::span(&frame, 1)) == 1)
      commands += decoder.read(frame).what == "toy command" ? 1 : 0;
  }
  EXPECT_EQ(lab.state().drive_state, +joint_state_t::DRIVE_ON);
  EXPECT_GE(commands, 2 * 3900);
  EXPECT_NEAR(lab.truth().p_BT[0] - before_m, 0.02, 0.0002);
}

TEST_F(AddedFamily, IsInTheDbcFile) {
  const auto messages = bus_tools::dbc_messages(load().robot, 0);
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_EQ(messages[1].name, "elbow_command");
}

TEST_F(AddedFamily, ReactsToEveryFaultInTime) {
  const LoadedRobot robot = load();
  ASSERT_EQ(faults::family_of(robot.robot.joints[0].drive).protocol, "toy");
  for (const faults::Fault& fault : faults::bus_faults()) {
    if (!faults::applies(fault, "toy")) continue;
    const faults::Reaction reaction = faults::react(fault, robot, {});
    if (fault.most_cycles > 0)
      EXPECT_TRUE(reaction.cycles > 0 && reaction.cycles <= fault.most_cycles)
          << fault.name << ": " << reaction.cycles;
    else
      EXPECT_LT(reaction.cycles, 0) << fault.name;
  }
}

}  // namespace
}  // namespace limber::test_added_family
