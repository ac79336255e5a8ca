// The `emergency_stop:` section: what a good one means, and one slip in it each.
#include "robots/loader/load_robot.h"
#include "tests/support/mutation.h"
#include "tests/support/source_path.h"

namespace limber::test_emergency_stop_yaml {
namespace {

const std::string kData = source_path("tests/robots/data/");

/// A robot.yaml beside the test arm's URDF, with this section.
struct Folder {
  explicit Folder(const std::string& section) {
    folder.write("robot.urdf", testing::read_text(kData + "arm/robot.urdf"));
    folder.write("robot.yaml", testing::read_text(kData + "arm/robot.yaml") + "emergency_stop: {" +
                                   section + "}\n");
  }
  Robot robot() const { return load_robot(folder.path()).robot; }
  std::string refusal() const {
    try {
      robot();
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  }
  testing::TemporaryFolder folder;
};

std::string bus_name() { return load_robot(kData + "arm/").robot.buses[1].name; }

TEST(EmergencyStopYaml, Absent) {
  EXPECT_FALSE(load_robot(kData + "arm/").robot.emergency_stop.has_value());
}

TEST(EmergencyStopYaml, DefaultsAndAll) {
  const Robot few = Folder("bus: " + bus_name() + ", id: 389").robot();
  ASSERT_TRUE(few.emergency_stop.has_value());
  EXPECT_EQ(few.emergency_stop->bus, 1);
  EXPECT_EQ(few.emergency_stop->id, 389U);
  EXPECT_EQ(few.emergency_stop->byte, 0);
  EXPECT_EQ(few.emergency_stop->mask, 1);
  EXPECT_EQ(few.emergency_stop->released, 1);
  EXPECT_EQ(few.emergency_stop->timeout_s, 0.1);
  EXPECT_EQ(few.emergency_stop->power_off_s, 0.5);
  const Robot all = Folder("bus: " + bus_name() +
                           ", id: 389, byte: 3, mask: 6, released: 4, timeout_s: 0.05, "
                           "power_off_s: 1")
                        .robot();
  EXPECT_EQ(all.emergency_stop->byte, 3);
  EXPECT_EQ(all.emergency_stop->mask, 6);
  EXPECT_EQ(all.emergency_stop->released, 4);
  EXPECT_EQ(all.emergency_stop->timeout_s, 0.05);
  EXPECT_EQ(all.emergency_stop->power_off_s, 1.0);
}

TEST(EmergencyStopYaml, EachSlipIsNamed) {
  const std::string good = "bus: " + bus_name() + ", id: 389";
  const Robot robot = load_robot(kData + "arm/").robot;
  std::uint32_t taken = 0;
  for (const JointConfig& joint : robot.joints) {
    if (joint.drive.bus == 1) taken = joint.drive.command_id;
  }
  for (const auto& [section, words] : std::vector<std::pair<std::string, std::string>>{
           {"bus: nowhere, id: 389", "bus"},
           {"bus: " + bus_name(), "id"},
           {"bus: " + bus_name() + ", id: " + std::to_string(taken), "is taken by"},
           {good + ", byte: 8", "byte"},
           {good + ", mask: 0", "mask"},
           {good + ", mask: 1, released: 2", "could never be seen"},
           {good + ", timeout_s: 0", "timeout_s"},
           {good + ", power_off_s: .nan", "power_off_s"},
           {good + ", gpio: 3", "gpio"}}) {
    const std::string text = Folder(section).refusal();
    EXPECT_NE(text.find(words), std::string::npos) << section << ": " << text;
  }
}

}  // namespace
}  // namespace limber::test_emergency_stop_yaml
