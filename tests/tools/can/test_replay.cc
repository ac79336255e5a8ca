// What a recording sends again, and where it never goes by itself.
#include <gtest/gtest.h>

#include <array>
#include <csignal>
#include <cstdlib>

#include "common/config_error.h"
#include "drivers/can/can_bus.h"
#include "tests/drivers/can/private_network.h"
#include "tests/support/mutation.h"
#include "tests/tools/can/arms.h"
#include "tools/can/frame_source.h"
#include "tools/can/replay.h"

namespace limber::test_replay {
namespace {

using bus_tools::replay;

const bool kPrivateNetwork = [] {
  setenv("LIMBER_VIRTUAL_BUS_PORT", "43214", 1);
  return testing::enter_private_network();
}();

const char* const kLog =
    "(5.000000) one 003#FFFFFFFFFFFFFFFD\n"
    "(5.001000) one 013#0387AD7DD9702926\n"
    "(5.001500) one 20000040#0000000000000000\n"
    "(5.003000) one 123#01\n";
const volatile std::sig_atomic_t kGoOn = 0;

struct Replay : ::testing::Test {
  testing::TemporaryFolder folder;
  Robot robot = testing::one_motor("damiao_mit", 0x003, 0x013);
  std::string file = folder.write("run.can.log", kLog);

  std::string refusal(const bus_tools::ReplayOptions& options) {
    try {
      replay(robot, options, kGoOn);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  }
  /// Identifiers that arrive at another end.
  std::vector<std::uint32_t> sent(const std::string& only) {
    const auto end = open_can_bus("virtual:one", true);
    replay(robot, {file, false, only}, kGoOn);
    std::array<CanFrame, 16> frames;
    const int count = end->receive(frames);
    std::vector<std::uint32_t> ids;
    for (int i = 0; i < count; ++i) ids.push_back(frames[static_cast<std::size_t>(i)].id);
    return ids;
  }
};

TEST_F(Replay, NeverToABusThatMayCarryAnArm) {
  robot.buses[0].can = "socketcan:nowhere0";
  file = folder.write("arm.log", "(5.0) arm 003#FFFFFFFFFFFFFFFD\n");
  const std::string text = refusal({file, false, ""});
  EXPECT_NE(text.find("may move it"), std::string::npos) << text;
  EXPECT_NE(text.find("--force"), std::string::npos) << text;
  // By force it is opened, which fails for another reason here.
  EXPECT_NE(refusal({file, true, ""}).find("socketcan:nowhere0"), std::string::npos);
  EXPECT_EQ(refusal({file, true, ""}).find("--force"), std::string::npos);
}

TEST_F(Replay, SendsEverythingButErrorFramesInOrder) {
  EXPECT_EQ(sent(""), (std::vector<std::uint32_t>{0x003, 0x013, 0x123}));
}

TEST_F(Replay, OneDirectionAlone) {
  EXPECT_EQ(sent("commands"), std::vector<std::uint32_t>{0x003});
  EXPECT_EQ(sent("replies"), std::vector<std::uint32_t>{0x013});
}

TEST_F(Replay, FilesOfOtherInterfacesAndDamagedOnesAreRefusedBeforeAnythingIsSent) {
  file = folder.write("other.log", "(1.0) can3 003#FFFFFFFFFFFFFFFD\n");
  EXPECT_NE(refusal({file, false, ""}).find("--bus arm=socketcan:can3"), std::string::npos);
  file = folder.write("damaged.log", std::string(kLog) + "rubbish\n");
  EXPECT_NE(refusal({file, false, ""}).find("damaged.log:5"), std::string::npos);
}

TEST_F(Replay, AFilesInterfaceIsTheBusOrItsAddress) {
  EXPECT_EQ(bus_tools::bus_of_interface(robot, "arm"), 0);
  EXPECT_EQ(bus_tools::bus_of_interface(robot, "one"), 0);
  EXPECT_EQ(bus_tools::bus_of_interface(robot, "two"), std::nullopt);
}

// `candump -l any`: a gripper on can1, the arm on "one".
TEST_F(Replay, OtherInterfacesOfAFileAreLeftOutAndCounted) {
  const std::string mixed = std::string(kLog) + "(5.004) can1 1A0#00\n(5.005) can1 1A0#01\n";
  file = folder.write("any.log", mixed);
  std::vector<std::uint32_t> read;
  const auto losses = bus_tools::each_frame(robot, {.file = file},
                                            [&](std::int64_t, int bus, const CanFrame& frame) {
                                              EXPECT_EQ(bus, 0);
                                              read.push_back(frame.id);
                                              return true;
                                            });
  EXPECT_EQ(read.size(), 4U);
  ASSERT_EQ(losses.elsewhere.size(), 1U);
  EXPECT_EQ(losses.elsewhere.at("can1"), 2);
  const std::string told = bus_tools::elsewhere_text(robot, losses);
  EXPECT_NE(told.find("can1 (2 frames): none of one's buses, which are arm (one)"),
            std::string::npos)
      << told;
  EXPECT_EQ(replay(robot, {file, false, ""}, kGoOn).left_out, 3);  // an error frame, and can1's
}

}  // namespace
}  // namespace limber::test_replay
