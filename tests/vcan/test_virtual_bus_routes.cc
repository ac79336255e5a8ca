// The virtual bus in the networks that machines really have. Each test makes one, so it needs the
// lab's permissions.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <functional>
#include <string>

#include "common/config_error.h"
#include "tests/drivers/can/private_network.h"
#include "tests/vcan/lab.h"

namespace limber::test_virtual_bus_routes {
namespace {

/// Runs a check in a process and network of its own.
bool holds_in_new_network(const std::function<bool()>& check) {
  const pid_t child = fork();
  if (child == 0)
    _exit(testing::enter_private_network(false) && check() ? EXIT_SUCCESS : EXIT_FAILURE);
  int status = 0;
  return child > 0 && waitpid(child, &status, 0) == child && status == EXIT_SUCCESS;
}

bool shell(const char* command) { return std::system(command) == 0; }

bool two_ends_hear_each_other() {
  const auto a = open_can_bus("virtual:routes", true);
  const auto b = open_can_bus("virtual:routes", true);
  return a->send(testing::numbered(1)) == 1 && testing::receive(b.get(), 1).size() == 1 &&
         testing::is_silent(a.get());
}

constexpr const char* kEthernet =
    "ip link add e0 type veth peer name e1 && ip addr add 192.0.2.2/24 dev e0 && ip link set e0 up "
    "&& ip link set e1 up && "
    "ip route add default via 192.0.2.1";
constexpr const char* kRouteOnLoopback =
    "ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo";

TEST(VirtualBusRoutes, WithoutAnyTheUserReadsTheTwoCommands) {
  EXPECT_TRUE(holds_in_new_network([] {
    try {
      open_can_bus("virtual:default", true);
    } catch (const ConfigError& error) {
      const std::string text = error.what();
      return text.find("ip link set lo multicast on") != std::string::npos &&
             text.find("ip route add 224.0.0.0/4 dev lo") != std::string::npos;
    }
    return false;
  }));
}

TEST(VirtualBusRoutes, LoopbackOnly) {
  EXPECT_TRUE(
      holds_in_new_network([] { return shell(kRouteOnLoopback) && two_ends_hear_each_other(); }));
}

TEST(VirtualBusRoutes, DefaultRouteOverEthernet) {
  EXPECT_TRUE(holds_in_new_network([] { return shell(kEthernet) && two_ends_hear_each_other(); }));
}

// Here the kernel gives frames on lo the address of e0.
TEST(VirtualBusRoutes, MulticastOnLoopbackBesideEthernet) {
  EXPECT_TRUE(holds_in_new_network(
      [] { return shell(kEthernet) && shell(kRouteOnLoopback) && two_ends_hear_each_other(); }));
}

// Frames and other traffic of the kernel's that have come out of the far end of the cable.
int packets_at_far_end() {
  std::ifstream devices("/proc/self/net/dev");
  for (std::string line; std::getline(devices, line);) {
    long bytes = 0;
    int packets = 0;
    if (std::sscanf(line.c_str(), " e1: %ld %d", &bytes, &packets) == 2) return packets;
  }
  return -1;
}

TEST(VirtualBusRoutes, FramesDoNotLeaveTheHost) {
  EXPECT_TRUE(holds_in_new_network([] {
    if (!shell(kEthernet) || !two_ends_hear_each_other()) return false;
    const auto bus = open_can_bus("virtual:routes", true);
    const int before = packets_at_far_end();
    for (int i = 0; i < 1000; ++i) bus->send(testing::numbered(1));
    return before >= 0 && packets_at_far_end() - before < 500;
  }));
}

}  // namespace
}  // namespace limber::test_virtual_bus_routes
