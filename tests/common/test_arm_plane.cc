// The arm plane: LCM's bytes, and who may send to a Unix socket.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limber/joint_command_t.hpp>
#include <limber/joint_state_t.hpp>
#include <string>

#include "common/arm_plane/arm_plane.h"
#include "common/config_error.h"
#include "tests/support/mutation.h"

namespace limber::test_arm_plane {
namespace {

/// A folder of this user's alone.
class Folder : public testing::TemporaryFolder {
 public:
  std::string url() const { return "unix:" + path() + "/arm"; }
};

std::string refusal(const std::string& url) {
  try {
    ArmPlane plane(url, ArmPlaneEnd::kDriver);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

std::vector<std::uint8_t> bytes(std::string_view text) { return {text.begin(), text.end()}; }

TEST(LcmDatagram, HasLcmsBytes) {
  std::array<std::uint8_t, 100> out{};
  const std::size_t size = write_lcm_header("JOINT_STATE", 0x01020304, out);
  using namespace std::string_view_literals;
  EXPECT_EQ(std::vector(out.begin(), out.begin() + static_cast<long>(size)),
            bytes("LC02\x01\x02\x03\x04JOINT_STATE\0"sv));
}

TEST(LcmDatagram, IsReadBack) {
  using namespace std::string_view_literals;
  const auto whole = bytes("LC02\0\0\0\7TAU\0message"sv);
  const auto datagram = read_lcm_datagram(whole);
  ASSERT_TRUE(datagram);
  EXPECT_EQ(datagram->channel, "TAU");
  EXPECT_EQ(std::vector(datagram->message.begin(), datagram->message.end()), bytes("message"));
}

TEST(LcmDatagram, FragmentsAndBrokenOnesAreNone) {
  using namespace std::string_view_literals;
  for (const auto text :
       {"LC03\0\0\0\7TAU\0message"sv, "LC02\0\0\0\2AB"sv, "LC02\0\0\0"sv, ""sv, "LC02\0\0\0\2"sv})
    EXPECT_FALSE(read_lcm_datagram(bytes(text))) << text;
  for (const std::size_t length : {kLongestChannel, kLongestChannel + 1}) {
    auto datagram = bytes("LC02\0\0\0\2"sv);
    datagram.insert(datagram.end(), length, 'x');
    datagram.push_back(0);
    EXPECT_EQ(read_lcm_datagram(datagram).has_value(), length == kLongestChannel);
  }
}

TEST(UnixArmPlane, CarriesBothMessages) {
  const Folder folder;
  ArmPlane driver(folder.url(), ArmPlaneEnd::kDriver);
  ArmPlane controller(folder.url(), ArmPlaneEnd::kController);
  double q = NAN;
  double tau = NAN;
  controller.subscribe<joint_state_t>("JOINT_STATE", [&](const joint_state_t& s) { q = s.q[3]; });
  driver.subscribe<joint_command_t>("JOINT_TORQUE",
                                    [&](const joint_command_t& c) { tau = c.tau[2]; });
  joint_state_t state{};
  state.q[3] = 0.25;
  joint_command_t command{};
  command.tau[2] = -1.5;
  EXPECT_TRUE(driver.publish("JOINT_STATE", state));
  EXPECT_TRUE(controller.publish("JOINT_TORQUE", command));
  controller.handle_waiting();
  driver.handle_waiting();
  EXPECT_EQ(q, 0.25);
  EXPECT_EQ(tau, -1.5);
  EXPECT_EQ(driver.undecodable() + controller.undecodable(), 0);
}

TEST(UnixArmPlane, OtherMessagesAreCountedAndDropped) {
  const Folder folder;
  ArmPlane driver(folder.url(), ArmPlaneEnd::kDriver);
  ArmPlane controller(folder.url(), ArmPlaneEnd::kController);
  int handled = 0;
  driver.subscribe<joint_command_t>("JOINT_TORQUE", [&](const joint_command_t&) { ++handled; });
  EXPECT_TRUE(controller.publish("JOINT_TORQUE", joint_state_t{}));   // another type
  EXPECT_TRUE(controller.publish("JOINT_STATE", joint_command_t{}));  // another channel
  driver.handle_waiting();
  EXPECT_EQ(handled, 0);
  EXPECT_EQ(driver.undecodable(), 1);
}

TEST(UnixArmPlane, AnotherUserIsNotHeard) {
  if (geteuid() != 0) GTEST_SKIP() << "needs root, to become another user";
  const Folder folder;
  chmod(folder.path().c_str(), 0755);
  ArmPlane driver(folder.url(), ArmPlaneEnd::kDriver);
  chmod((folder.path() + "/arm.driver").c_str(), 0666);  // so that only the check is in the way
  int handled = 0;
  driver.subscribe<joint_command_t>("JOINT_TORQUE", [&](const joint_command_t&) { ++handled; });
  const auto send_as = [&](uid_t user, gid_t group) {
    ArmPlane controller(folder.url(), ArmPlaneEnd::kController);
    const pid_t child = fork();
    if (child == 0) {
      const bool became = setresgid(group, group, group) == 0 && setresuid(user, user, user) == 0;
      _exit(became && controller.publish("JOINT_TORQUE", joint_command_t{}) ? 0 : 1);
    }
    int status = 1;
    waitpid(child, &status, 0);
    ASSERT_EQ(status, 0);
    driver.handle_waiting();
  };
  send_as(65534, 65534);
  EXPECT_EQ(handled, 0);
  EXPECT_EQ(driver.undecodable(), 1);
  send_as(65534, getegid());  // of the folder's group
  EXPECT_EQ(handled, 1);
  send_as(0, 65534);
  EXPECT_EQ(handled, 2);
}

TEST(UnixArmPlane, NobodyThereIsNoError) {
  const Folder folder;
  ArmPlane driver(folder.url(), ArmPlaneEnd::kDriver);
  EXPECT_FALSE(driver.publish("JOINT_STATE", joint_state_t{}));
  driver.handle_waiting();
}

TEST(UnixArmPlane, AKilledProcessLeavesNothingInTheWay) {
  const Folder folder;
  const pid_t child = fork();
  if (child == 0) {
    ArmPlane driver(folder.url(), ArmPlaneEnd::kDriver);
    _exit(0);  // without destructors, as if killed
  }
  waitpid(child, nullptr, 0);
  ASSERT_TRUE(std::filesystem::exists(folder.path() + "/arm.driver"));
  EXPECT_EQ(refusal(folder.url()), "");
  EXPECT_FALSE(std::filesystem::exists(folder.path() + "/arm.driver"));
}

TEST(UnixArmPlane, IsRefusedWhereOthersCouldTakeAnEnd) {
  const Folder folder;
  ArmPlane driver(folder.url(), ArmPlaneEnd::kDriver);
  EXPECT_NE(refusal(folder.url()).find("process " + std::to_string(getpid())), std::string::npos)
      << refusal(folder.url());
  EXPECT_NE(refusal("unix:/tmp/arm").find("writable for everybody"), std::string::npos);
  EXPECT_NE(refusal("unix:arm").find("absolute"), std::string::npos);
  EXPECT_NE(refusal("unix:/no/such/folder").find("No such file"), std::string::npos);
  EXPECT_NE(refusal("unix:" + folder.path() + "/" + std::string(100, 'a')).find("96 characters"),
            std::string::npos);
}

}  // namespace
}  // namespace limber::test_arm_plane
