// The virtual bus over real sockets, alone and together with python-can, in a network of its own
// where the system allows it; and in shared memory.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "common/clock.h"
#include "common/config_error.h"
#include "drivers/can/virtual_bus.h"
#include "drivers/can/virtual_frame.h"
#include "tests/drivers/can/private_network.h"
#include "tests/support/bus_frames.h"
#include "tests/support/source_path.h"
#include "tools/allocations/allocations.h"

namespace limber::test_virtual_bus {
namespace {

constexpr const char* kPort = "43213";  // beside the default, in case the network is not private
const bool kPrivateNetwork = [] {
  setenv("LIMBER_VIRTUAL_BUS_PORT", kPort, 1);
  return testing::enter_private_network();
}();

using testing::is_silent;
using testing::kSecond;
using testing::numbered;
using testing::receive;

/// Over both carriers.
class VirtualBus : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override { setenv("LIMBER_VIRTUAL_BUS", GetParam().c_str(), 1); }
  void TearDown() override {
    unsetenv("LIMBER_VIRTUAL_BUS");
    for (const auto& file : std::filesystem::directory_iterator("/dev/shm"))
      if (file.path().string().find(std::string("-") + kPort) != std::string::npos)
        std::filesystem::remove(file.path());
  }
};
INSTANTIATE_TEST_SUITE_P(All, VirtualBus, ::testing::Values("udp", "shm", "shm?poll"));

TEST_P(VirtualBus, FramesReachEveryOtherEndInOrderAndNotTheSender) {
  const auto a = open_can_bus("virtual:order", true);
  const auto b = open_can_bus("virtual:order", true);
  const auto c = open_can_bus("virtual:order", true);
  std::vector<CanFrame> sent;
  for (std::uint32_t id = 1; id <= 100; ++id) sent.push_back(numbered(id));
  ASSERT_EQ(a->send(sent), 100);
  for (CanBus* end : {b.get(), c.get()}) {
    const auto got = receive(end, 100);
    ASSERT_EQ(got.size(), 100U);
    for (std::size_t i = 0; i < got.size(); ++i) {
      EXPECT_EQ(got[i].id, sent[i].id);
      EXPECT_EQ(got[i].data, sent[i].data);
    }
  }
  EXPECT_TRUE(is_silent(a.get())) << "own frames must not even wake the sender";
  EXPECT_EQ(a->statistics().sent, 100);
  EXPECT_EQ(b->statistics().received, 100);
}

TEST_P(VirtualBus, BusesOfOtherNamesStayApart) {
  const auto a = open_can_bus("virtual:left", true);
  const auto b = open_can_bus("virtual:right", true);
  const auto c = open_can_bus("virtual:default", true);
  a->send(numbered(1));
  EXPECT_TRUE(is_silent(b.get()));
  EXPECT_TRUE(is_silent(c.get()));
}

TEST_P(VirtualBus, AnEndWithoutFdNeitherSendsNorHearsFd) {
  const auto classic = open_can_bus("virtual:mixed", false);
  const auto fd = open_can_bus("virtual:mixed", true);
  CanFrame frame = numbered(1);
  frame.fd = frame.bitrate_switch = true;
  EXPECT_EQ(classic->send(std::array{frame, numbered(3)}), 1);
  EXPECT_EQ(classic->statistics().send_refused, 1);
  EXPECT_EQ(receive(fd.get(), 1).size(), 1U);
  EXPECT_EQ(fd->send(std::array{frame, numbered(2)}), 2);
  const auto got = receive(classic.get(), 1);
  ASSERT_EQ(got.size(), 1U);
  EXPECT_EQ(got[0].id, 2U);
  EXPECT_EQ(classic->statistics().malformed, 0);
}

TEST_P(VirtualBus, ImpossibleFramesAreRefusedAndTheOthersSent) {
  const auto a = open_can_bus("virtual:refusal", true);
  const auto b = open_can_bus("virtual:refusal", true);
  EXPECT_EQ(a->send(std::array{numbered(1), numbered(0x800), numbered(2)}), 2);
  EXPECT_EQ(a->statistics().send_refused, 1);
  EXPECT_EQ(receive(b.get(), 2).size(), 2U);
}

TEST_P(VirtualBus, StampsAreMonotonicTimeOfArrival) {
  const auto a = open_can_bus("virtual:time", true);
  const auto b = open_can_bus("virtual:time", true);
  testing::expect_stamps_of_arrival(a.get(), b.get());
}

/// Any datagram to a bus, or to another address on its port.
void send_raw(const std::string& address, std::span<const std::uint8_t> datagram) {
  const int raw = socket(AF_INET, SOCK_DGRAM, 0);
  const int ttl = 0;
  ASSERT_EQ(setsockopt(raw, IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof(ttl)), 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(std::atoi(kPort)));
  ASSERT_EQ(inet_pton(AF_INET, address.c_str(), &to.sin_addr), 1);
  sendto(raw, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&to),
         sizeof(to));
  close(raw);
}

std::vector<std::uint8_t> good_datagram() {
  std::vector<std::uint8_t> bytes(kLongestEncodedBytes);
  bytes.resize(encode_datagram(numbered(7), bytes));
  return bytes;
}

TEST(VirtualBusDatagrams, MalformedDatagramsAreCountedAndDoNoHarm) {
  const auto a = open_can_bus("virtual:noise", true);
  const auto b = open_can_bus("virtual:noise", true);
  const std::string group = virtual_bus_group("noise");
  send_raw(group, {});
  send_raw(group, std::vector<std::uint8_t>{'h', 'e', 'l', 'l', 'o'});
  send_raw(group, std::vector<std::uint8_t>(1400, 0x91));
  // A good map of 1024 bytes, padded in a key of its own, then with a byte behind it that must not
  // be cut off and forgotten.
  std::vector<std::uint8_t> longer = good_datagram();
  ++longer[0];
  longer.insert(longer.end(), {0xA1, 'x', 0xC5, 0, 0});
  const std::size_t padding = 1024 - longer.size();
  longer[longer.size() - 2] = static_cast<std::uint8_t>(padding >> 8U);
  longer[longer.size() - 1] = static_cast<std::uint8_t>(padding);
  longer.resize(1024);
  send_raw(group, longer);
  ASSERT_EQ(receive(b.get(), 1).size(), 1U) << "1024 bytes are allowed";
  longer.push_back(0xC0);
  send_raw(group, longer);
  a->send(numbered(1));
  const auto got = receive(b.get(), 1);
  ASSERT_EQ(got.size(), 1U);
  EXPECT_EQ(got[0].id, 1U);
  EXPECT_EQ(b->statistics().malformed, 4);
}

TEST(VirtualBusDatagrams, OnlyTheGroupIsHeard) {
  const auto bus = open_can_bus("virtual:group", true);
  send_raw("127.0.0.1", good_datagram());
  EXPECT_TRUE(is_silent(bus.get()));
  send_raw(virtual_bus_group("group"), good_datagram());
  EXPECT_FALSE(is_silent(bus.get()));
}

TEST_P(VirtualBus, LossesInTheReceiveQueueAreCounted) {
  const auto a = open_can_bus("virtual:flood", true);
  const auto b = open_can_bus("virtual:flood", true);
  std::array<CanFrame, 64> many;
  many.fill(numbered(1));
  for (int i = 0; i < 2000; ++i) ASSERT_EQ(a->send(many), 64);
  std::int64_t got = 0;
  while (const int taken = b->receive(many)) got += taken;
  EXPECT_LT(got, 128'000);
  a->send(numbered(2));  // the kernel tells of its losses with the next frame it delivers
  got += static_cast<std::int64_t>(receive(b.get(), 1).size());
  EXPECT_EQ(got + b->statistics().overflow, 128'001);
  EXPECT_EQ(b->statistics().received, got);
}

TEST_P(VirtualBus, WaitingEndsWithAFrameOrAtTheDeadline) {
  const auto a = open_can_bus("virtual:wait", true);
  const auto b = open_can_bus("virtual:wait", true);
  CanBus* both[] = {a.get(), b.get()};
  EXPECT_FALSE(wait_readable(both, 0));
  const std::int64_t deadline_ns = monotonic_ns() + 20'000'000;
  EXPECT_FALSE(wait_readable(both, deadline_ns));
  EXPECT_GE(monotonic_ns(), deadline_ns);
  a->send(numbered(1));
  EXPECT_TRUE(wait_readable(both, monotonic_ns() + kSecond));
}

TEST_P(VirtualBus, DoesNotAllocateOnceOpen) {
  const auto a = open_can_bus("virtual:heap", true);
  const auto b = open_can_bus("virtual:heap", true);
  std::array<CanFrame, 64> frames;
  frames.fill(numbered(1));
  CanBus* ends[] = {a.get(), b.get()};
  const auto before = allocations();
  for (int i = 0; i < 10; ++i) {
    a->send(frames);
    b->send(numbered(2));
    wait_readable(ends, monotonic_ns() + kSecond);
    a->receive(frames);
    b->receive(frames);
  }
  EXPECT_EQ(allocations(), before);
}

TEST(VirtualBusName, GroupsAsDocumented) {
  EXPECT_EQ(virtual_bus_group("default"), "239.74.163.2");
  EXPECT_EQ(virtual_bus_group("239.1.2.3"), "239.1.2.3");
  // FNV-1a (32 bit) of "a" is 0xE40C292C (published test vector): 0xE40C ^ 0x292C = 0xCD20.
  EXPECT_EQ(virtual_bus_group("a"), "239.74.205.32");
  // "foobar": 0xBF9CF968, 0xBF9C ^ 0xF968 = 0x46F4.
  EXPECT_EQ(virtual_bus_group("foobar"), "239.74.70.244");
}

void expect_refused(const std::function<void()>& call, const std::string& reason) {
  try {
    call();
    ADD_FAILURE() << "not refused: " << reason;
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
  }
}

TEST(VirtualBusName, BadNamesAreRefusedWithWhatIsAllowed) {
  expect_refused([] { virtual_bus_group("10.0.0.1"); }, "224.0.0.0 to 239.255.255.255");
  expect_refused([] { virtual_bus_group("left arm"); }, "letters, digits");
}

TEST(VirtualBusName, BadCarriersAreRefused) {
  for (const char* carrier : {"", "tcp", "shm?spin"}) {
    setenv("LIMBER_VIRTUAL_BUS", carrier, 1);
    expect_refused([] { open_can_bus("virtual:default", true); }, "udp, shm and shm?poll are");
  }
  unsetenv("LIMBER_VIRTUAL_BUS");
}

TEST(VirtualBusName, BadPortsAreRefused) {
  for (const char* port : {"0", "65536", "-1", "43113x", ""}) {
    setenv("LIMBER_VIRTUAL_BUS_PORT", port, 1);
    expect_refused([] { open_can_bus("virtual:default", true); }, "1 to 65535");
  }
  setenv("LIMBER_VIRTUAL_BUS_PORT", kPort, 1);
}

// --- python-can at the other end ---

/// A frame as the Python side prints a message: id, flags, dlc, data.
std::string text(const CanFrame& frame) {
  std::ostringstream line;
  line << std::hex << frame.id << ' ' << (frame.extended ? 'X' : 'S') << (frame.remote ? 'R' : '-')
       << (frame.error ? 'E' : '-') << (frame.fd ? 'F' : '-') << (frame.bitrate_switch ? 'B' : '-')
       << ' ' << std::dec << int{frame.length} << ' ';
  for (std::size_t i = 0; i < frame.length && !frame.remote; ++i) {
    std::array<char, 3> byte{};
    std::snprintf(byte.data(), byte.size(), "%02x", frame.data[i]);
    line << byte.data();
  }
  return line.str();
}

std::vector<CanFrame> samples() {
  std::vector<CanFrame> frames(7);
  frames[0] = numbered(0x002);
  frames[1].id = 0x004;  // empty
  frames[2] = numbered(0x1FFFFFF0);
  frames[2].extended = true;
  frames[3].id = 0x006;
  frames[3].remote = true;
  frames[3].length = 4;
  frames[4] = numbered(0x008);
  frames[4].fd = frames[4].bitrate_switch = true;
  frames[4].length = 64;
  frames[4].data[63] = 0xEE;
  frames[5] = numbered(0x00A);
  frames[5].fd = true;
  frames[5].length = 12;
  frames[6].id = 0x040;  // bus-off
  frames[6].error = true;
  frames[6].length = 8;
  return frames;
}

TEST(PythonCan, HearsUsAndWeHearIt) {
  constexpr std::uint32_t kHello = 0x701;
  constexpr std::uint32_t kGoodbye = 0x700;
  const auto bus = open_can_bus("virtual:python", true);
  const std::string command = std::string(LIMBER_PYTHON) + " " +
                              source_path("tests/drivers/can/python_can_peer.py") + " " +
                              virtual_bus_group("python") + " " + kPort;
  const std::unique_ptr<FILE, int (*)(FILE*)> peer(popen(command.c_str(), "r"), pclose);
  ASSERT_NE(peer, nullptr);
  const auto hello = receive(bus.get(), 1, 30 * kSecond);
  ASSERT_EQ(hello.size(), 1U) << "python-can did not start: " << command;
  EXPECT_EQ(hello[0].id, kHello);

  std::string expected;
  for (const CanFrame& sample : samples()) {
    ASSERT_EQ(bus->send(sample), 1);
    CanFrame answer = sample;
    ++answer.id;
    const auto got = receive(bus.get(), 1, 5 * kSecond);
    ASSERT_EQ(got.size(), 1U) << text(sample);
    EXPECT_EQ(text(got[0]), text(answer));
    expected += text(sample) + "\n";
  }
  bus->send(numbered(kGoodbye));
  std::string heard;
  std::array<char, 512> line{};
  while (std::fgets(line.data(), line.size(), peer.get()) != nullptr) heard += line.data();
  EXPECT_EQ(heard, expected) << "what python-can has made of our frames";
  EXPECT_EQ(bus->statistics().malformed, 0);
}

}  // namespace
}  // namespace limber::test_virtual_bus
