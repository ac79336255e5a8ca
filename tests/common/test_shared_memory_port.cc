// The arm plane over shared memory: waiting, waking, and who may have an end.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <limber/joint_command_t.hpp>
#include <limber/joint_state_t.hpp>
#include <random>
#include <string>
#include <thread>

#include "common/arm_plane/arm_plane.h"
#include "common/arm_plane/shared_memory_address.h"
#include "common/clock.h"
#include "common/config_error.h"

namespace limber::test_shared_memory_port {
namespace {

constexpr std::int64_t kLong_ns = 60'000'000'000;

/// A name of this test's own, whose object goes away with it.
class SharedMemoryArmPlane : public testing::Test {
 protected:
  SharedMemoryArmPlane() { std::filesystem::remove(path()); }
  ~SharedMemoryArmPlane() override { std::filesystem::remove(path()); }

  static std::string url(const std::string& options = "") {
    static const std::string name = "shm:test-" + std::to_string(getpid());  // its children's, too
    return name + options;
  }
  static std::string path() { return parse_shared_memory_address(url()).place.path; }
  static std::string refusal(const std::string& at) {
    try {
      ArmPlane plane(at, ArmPlaneEnd::kDriver);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  }
  static void expect_refusal(const std::string& at, const std::string& part) {
    EXPECT_NE(refusal(at).find(part), std::string::npos) << at << ": " << refusal(at);
  }
};

/// The sequence numbers that an end has received.
struct States {
  explicit States(ArmPlane* plane) : plane_(plane) {
    plane->subscribe<joint_state_t>("JOINT_STATE",
                                    [this](const joint_state_t& s) { seen.push_back(s.seq); });
  }
  bool wait() { return plane_->wait(monotonic_ns() + kLong_ns); }
  std::vector<std::int64_t> seen;

 private:
  ArmPlane* plane_;
};

bool publish(ArmPlane& plane, std::int64_t seq) {
  joint_state_t state{};
  state.seq = seq;
  return plane.publish("JOINT_STATE", state);
}

TEST_F(SharedMemoryArmPlane, CarriesMessagesBothWays) {
  ArmPlane driver(url(), ArmPlaneEnd::kDriver);
  ArmPlane controller(url(), ArmPlaneEnd::kController);
  States states(&controller);
  double tau = 0.0;
  driver.subscribe<joint_command_t>("JOINT_TORQUE",
                                    [&](const joint_command_t& c) { tau = c.tau[2]; });
  joint_command_t command{};
  command.tau[2] = -1.5;
  EXPECT_TRUE(publish(driver, 7));
  EXPECT_TRUE(publish(driver, 8));
  EXPECT_TRUE(controller.publish("JOINT_TORQUE", command));
  EXPECT_TRUE(controller.wait(1));
  controller.handle_waiting();
  driver.handle_waiting();
  EXPECT_EQ(states.seen, (std::vector<std::int64_t>{7, 8}));
  EXPECT_EQ(tau, -1.5);
  EXPECT_EQ(driver.undecodable() + controller.undecodable(), 0);
}

TEST_F(SharedMemoryArmPlane, AWaitEndsWithItsDeadline) {
  for (const char* options : {"", "?poll"}) {
    ArmPlane controller(url(options), ArmPlaneEnd::kController);
    const std::int64_t deadline_ns = monotonic_ns() + 5'000'000;
    EXPECT_FALSE(controller.wait(deadline_ns));
    EXPECT_GE(monotonic_ns(), deadline_ns);
    EXPECT_FALSE(controller.wait(0));
  }
}

TEST_F(SharedMemoryArmPlane, EachMessageWakesTheOtherEndWhetherItSleepsOrPolls) {
  for (const char* options : {"", "?poll"}) {
    ArmPlane driver(url(options), ArmPlaneEnd::kDriver);
    ArmPlane controller(url(options), ArmPlaneEnd::kController);
    States states(&controller);
    int answers = 0;
    driver.subscribe<joint_command_t>("JOINT_TORQUE", [&](const joint_command_t&) { ++answers; });
    constexpr int kRounds = 2000;
    std::jthread thread([&] {
      for (int i = 0; i < kRounds; ++i) {
        if (!states.wait()) return;
        controller.handle_waiting();
        controller.publish("JOINT_TORQUE", joint_command_t{});
      }
    });
    for (int i = 0; i < kRounds; ++i) {
      // Now and then longer than an end spins: then both sleep.
      if (i % 500 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
      publish(driver, i);
      ASSERT_TRUE(driver.wait(monotonic_ns() + kLong_ns)) << i;
      driver.handle_waiting();
    }
    EXPECT_EQ(answers, kRounds);
    EXPECT_EQ(driver.undecodable() + controller.undecodable(), 0);
  }
}

TEST_F(SharedMemoryArmPlane, AnEndStartedAnewGoesOnAndReadsNothingOld) {
  ArmPlane controller(url(), ArmPlaneEnd::kController);
  States states(&controller);
  const pid_t child = fork();
  if (child == 0) {
    ArmPlane driver(url(), ArmPlaneEnd::kDriver);
    publish(driver, 1);
    _exit(0);  // without destructors, as if killed
  }
  waitpid(child, nullptr, 0);
  controller.handle_waiting();
  controller.publish("JOINT_TORQUE", joint_command_t{});
  ArmPlane driver(url(), ArmPlaneEnd::kDriver);
  int old = 0;
  driver.subscribe<joint_command_t>("JOINT_TORQUE", [&](const joint_command_t&) { ++old; });
  driver.handle_waiting();
  publish(driver, 2);
  controller.handle_waiting();
  EXPECT_EQ(states.seen, (std::vector<std::int64_t>{1, 2}));
  EXPECT_EQ(old, 0);
}

TEST_F(SharedMemoryArmPlane, ASecondProcessAtAnEndIsRefused) {
  ArmPlane driver(url(), ArmPlaneEnd::kDriver);
  expect_refusal(url("?poll"), "already a driver");
  expect_refusal(url(), "process " + std::to_string(getpid()));
  ArmPlane controller(url(), ArmPlaneEnd::kController);
}

TEST_F(SharedMemoryArmPlane, ItIsThisUsersAlone) {
  { const ArmPlane driver(url(), ArmPlaneEnd::kDriver); }
  struct stat details {};
  ASSERT_EQ(stat(path().c_str(), &details), 0);
  EXPECT_EQ(details.st_mode & 0777, 0600U);
  EXPECT_EQ(refusal(url()), "");
  chmod(path().c_str(), 0620);
  expect_refusal(url(), "writable for others");
  chmod(path().c_str(), 0602);
  expect_refusal(url(), "writable for others");
  if (geteuid() != 0) GTEST_SKIP() << "needs root, to give it to another user";
  chmod(path().c_str(), 0600);
  ASSERT_EQ(chown(path().c_str(), 65534, 65534), 0);
  expect_refusal(url(), "belongs to user 65534");
}

TEST_F(SharedMemoryArmPlane, AGroupHasItTogetherOnlyIfItIsNamed) {
  if (geteuid() != 0) GTEST_SKIP() << "needs root, to give it to a group";
  { const ArmPlane driver(url("?group=daemon"), ArmPlaneEnd::kDriver); }
  struct stat details {};
  ASSERT_EQ(stat(path().c_str(), &details), 0);
  EXPECT_EQ(details.st_mode & 0777, 0660U);
  EXPECT_EQ(details.st_gid, 1U);
  expect_refusal(url(), "writable for others");
  EXPECT_EQ(refusal(url("?group=daemon&poll")), "");
  expect_refusal(url("?group=bin"), "writable for others");
  ASSERT_EQ(chown(path().c_str(), 65534, 1), 0);
  EXPECT_EQ(refusal(url("?group=daemon")), "");
  chmod(path().c_str(), 0662);
  expect_refusal(url("?group=daemon"), "writable for others");
}

TEST_F(SharedMemoryArmPlane, WhatIsNoObjectOfOursIsRefused) {
  std::ofstream(path()) << "short";
  std::filesystem::permissions(path(), std::filesystem::perms::owner_all);
  expect_refusal(url(), "another version");
  std::filesystem::remove(path());
  std::filesystem::create_symlink("/etc/passwd", path());
  expect_refusal(url(), "cannot be opened");
  std::filesystem::remove(path());
  ASSERT_EQ(mkfifo(path().c_str(), 0600), 0);
  expect_refusal(url(), "no shared memory");
}

TEST_F(SharedMemoryArmPlane, AddressesAreChecked) {
  expect_refusal("shm:", "letters");
  expect_refusal("shm:../arm", "letters");
  expect_refusal("shm:" + std::string(65, 'a'), "letters");
  expect_refusal(url("?spin"), "'spin' is not known");
  expect_refusal(url("?group="), "'group=' is not known");
  expect_refusal(url("?group=no-such-group"), "no group 'no-such-group'");
}

/// A peer may write whatever it wants to all of the memory; the driver reads on, and hears a peer
/// that behaves again.
TEST_F(SharedMemoryArmPlane, GarbageFromThePeerIsPassedOver) {
  ArmPlane driver(url(), ArmPlaneEnd::kDriver);
  ArmPlane controller(url(), ArmPlaneEnd::kController);
  int handled = 0;
  driver.subscribe<joint_command_t>("JOINT_TORQUE", [&](const joint_command_t&) { ++handled; });
  const int file = open(path().c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_GE(file, 0);
  std::mt19937_64 random(2);
  std::vector<std::uint64_t> garbage(sizeof(SharedMemory) / 8);
  for (int round = 0; round < 50; ++round) {
    for (std::uint64_t& word : garbage) word = random();
    ASSERT_EQ(pwrite(file, garbage.data(), sizeof(SharedMemory), 0),
              static_cast<ssize_t>(sizeof(SharedMemory)));
    driver.wait(monotonic_ns() + 1000);
    driver.handle_waiting();
    EXPECT_EQ(handled, 0);
    EXPECT_TRUE(publish(driver, round));
  }
  close(file);
  EXPECT_GT(driver.undecodable(), 0);
  controller.publish("JOINT_TORQUE", joint_command_t{});
  driver.handle_waiting();
  handled = 0;
  controller.publish("JOINT_TORQUE", joint_command_t{});
  driver.handle_waiting();
  EXPECT_EQ(handled, 1);
}

}  // namespace
}  // namespace limber::test_shared_memory_port
