// The SocketCAN bus on interfaces of a real kernel: what it carries, what it refuses, and what it
// does when links fail.
#include <gtest/gtest.h>
#include <linux/can/error.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>

#include "common/config_error.h"
#include "drivers/can/link_details.h"
#include "drivers/can/socketcan.h"
#include "tests/vcan/lab.h"
#include "tools/allocations/allocations.h"

namespace limber::test_socketcan {
namespace {

using testing::is_silent;
using testing::kSecond;
using testing::numbered;
using testing::receive;
using testing::run;

void expect_same(const CanFrame& a, const CanFrame& b) {
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.extended, b.extended);
  EXPECT_EQ(a.remote, b.remote);
  EXPECT_EQ(a.fd, b.fd);
  EXPECT_EQ(a.bitrate_switch, b.bitrate_switch);
  EXPECT_EQ(a.length, b.length);
  EXPECT_EQ(a.data, b.data);
}

std::string refusal(const std::string& interface, bool fd) {
  try {
    open_socketcan(interface, fd);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "opened";
}

void expect_contains(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text << "\n  lacks: " << part;
}

TEST(SocketCan, CarriesEveryKindOfFrame) {
  const auto a = open_can_bus("socketcan:vcan0", true);
  const auto b = open_can_bus("socketcan:vcan0", true);
  std::vector<CanFrame> sent(6);
  sent[0] = numbered(0x7FF);
  sent[1].id = 1;  // empty
  sent[2] = numbered(0x1FFFFFFF);
  sent[2].extended = true;
  sent[3].id = 0x123;
  sent[3].remote = true;
  sent[3].length = 5;
  sent[4] = numbered(3);
  sent[4].fd = sent[4].bitrate_switch = true;
  sent[4].length = 64;
  sent[4].data[63] = 0xEE;
  sent[5] = numbered(4);
  sent[5].fd = true;
  CanFrame careless = sent[3];
  careless.data[0] = 0xAA;  // a remote frame has no data, whatever lies in its buffer
  ASSERT_EQ(a->send(std::array{sent[0], sent[1], sent[2], careless, sent[4], sent[5]}), 6);
  const auto got = receive(b.get(), 6);
  ASSERT_EQ(got.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    SCOPED_TRACE("frame " + std::to_string(i));
    expect_same(got[i], sent[i]);
  }
  EXPECT_EQ(a->statistics().sent, 6);
  EXPECT_EQ(b->statistics().received, 6);
  EXPECT_EQ(b->statistics().malformed, 0);
}

TEST(SocketCan, OwnFramesDoNotComeBack) {
  const auto a = open_can_bus("socketcan:vcan0", true);
  const auto b = open_can_bus("socketcan:vcan0", true);
  a->send(numbered(1));
  EXPECT_EQ(receive(b.get(), 1).size(), 1U);
  EXPECT_TRUE(is_silent(a.get()));
}

TEST(SocketCan, BusesStayApart) {
  const auto a = open_can_bus("socketcan:vcan0", true);
  const auto b = open_can_bus("socketcan:vcan1", true);
  a->send(numbered(1));
  EXPECT_TRUE(is_silent(b.get()));
}

TEST(SocketCan, MoreThanOneBatchKeepsItsOrder) {
  const auto a = open_can_bus("socketcan:vcan0", true);
  const auto b = open_can_bus("socketcan:vcan0", true);
  std::vector<CanFrame> sent;
  for (std::uint32_t id = 0; id < 150; ++id) sent.push_back(numbered(id));
  ASSERT_EQ(a->send(sent), 150);
  const auto got = receive(b.get(), 150);
  ASSERT_EQ(got.size(), 150U);
  for (std::uint32_t id = 0; id < 150; ++id) EXPECT_EQ(got[id].id, id);
}

TEST(SocketCan, ExtendedFramesAreNotTakenForStandardOnes) {
  const auto a = open_can_bus("socketcan:vcan0", false);
  const auto b = open_can_bus("socketcan:vcan0", false);
  CanFrame foreign = numbered(0x13);
  foreign.extended = true;
  a->send(std::array{foreign, numbered(0x13)});
  const auto got = receive(b.get(), 2);
  ASSERT_EQ(got.size(), 2U);
  EXPECT_TRUE(got[0].extended);
  EXPECT_FALSE(got[1].extended);
}

TEST(SocketCan, StampsAreMonotonicTimeOfArrival) {
  const auto a = open_can_bus("socketcan:vcan0", true);
  const auto b = open_can_bus("socketcan:vcan0", true);
  testing::expect_stamps_of_arrival(a.get(), b.get());
}

TEST(SocketCan, AnEndWithoutFdNeitherSendsNorHearsFd) {
  const auto classic = open_can_bus("socketcan:vcan0", false);
  const auto fd = open_can_bus("socketcan:vcan0", true);
  CanFrame frame = numbered(1);
  frame.fd = true;
  EXPECT_EQ(classic->send(std::array{frame, numbered(3)}), 1);
  EXPECT_EQ(classic->statistics().send_refused, 1);
  EXPECT_EQ(receive(fd.get(), 1).size(), 1U);
  EXPECT_EQ(fd->send(std::array{frame, numbered(2)}), 2);
  const auto got = receive(classic.get(), 1);
  ASSERT_EQ(got.size(), 1U);
  EXPECT_EQ(got[0].id, 2U);
}

TEST(SocketCan, ImpossibleFramesAreRefusedAndTheOthersSent) {
  const auto a = open_can_bus("socketcan:vcan0", true);
  const auto b = open_can_bus("socketcan:vcan0", true);
  EXPECT_EQ(a->send(std::array{numbered(1), numbered(0x800), numbered(2)}), 2);
  EXPECT_EQ(a->statistics().send_refused, 1);
  EXPECT_EQ(receive(b.get(), 2).size(), 2U);
}

// --- faults while running ---

TEST(SocketCanFaults, BusOffUntilTheControllerRestarts) {
  const auto bus = open_can_bus("socketcan:vcan0", true);
  const auto adapter =
      open_can_bus("socketcan:vcan0", true);  // on vcan anybody may speak for the controller
  const auto report = [&](std::uint32_t error_class) {
    CanFrame error;
    error.error = true;
    error.id = error_class;
    error.length = 8;
    ASSERT_EQ(adapter->send(error), 1);
    const auto got = receive(bus.get(), 1);
    ASSERT_EQ(got.size(), 1U);
    EXPECT_TRUE(got[0].error);
    EXPECT_EQ(got[0].id, error_class);
  };
  report(CAN_ERR_ACK);
  EXPECT_FALSE(bus->statistics().bus_off);
  report(CAN_ERR_BUSOFF);
  EXPECT_TRUE(bus->statistics().bus_off);
  adapter->send(numbered(1));
  receive(bus.get(), 1);
  EXPECT_TRUE(bus->statistics().bus_off) << "a frame on the bus restarts no controller";
  report(CAN_ERR_RESTARTED);
  EXPECT_FALSE(bus->statistics().bus_off);
  EXPECT_EQ(bus->statistics().error_frames, 3);
}

TEST(SocketCanFaults, ALinkThatGoesDownAndComesBack) {
  const auto a = open_can_bus("socketcan:vcan1", true);
  const auto b = open_can_bus("socketcan:vcan1", true);
  CanFrame frame;
  frame.error = true;
  frame.id = CAN_ERR_BUSOFF;
  frame.length = 8;
  b->send(frame);
  receive(a.get(), 1);
  EXPECT_TRUE(a->statistics().bus_off);
  run("ip link set vcan1 down");
  EXPECT_EQ(a->receive(std::span(&frame, 1)), 0);
  EXPECT_TRUE(a->statistics().link_down);
  EXPECT_EQ(a->statistics().last_errno, ENETDOWN);
  EXPECT_EQ(a->send(std::array{numbered(1), numbered(2)}), 0);
  EXPECT_EQ(a->statistics().send_refused, 2);
  EXPECT_TRUE(is_silent(a.get()));
  EXPECT_TRUE(a->statistics().link_down);
  run("ip link set vcan1 up");
  EXPECT_EQ(a->send(numbered(3)), 1);
  EXPECT_FALSE(a->statistics().link_down);
  EXPECT_FALSE(a->statistics().bus_off) << "a controller that was stopped starts afresh";
  ASSERT_EQ(b->receive(std::span(&frame, 1)), 1)
      << "the late report must not hide the frame behind it";
  EXPECT_EQ(frame.id, 3U);
  EXPECT_EQ(b->statistics().last_errno, ENETDOWN);
  EXPECT_FALSE(b->statistics().link_down);
}

/// Sends until the bus takes a frame; false after ten seconds.
bool sends_again(CanBus* bus) {
  for (int i = 0; i < 500; ++i) {
    if (bus->send(numbered(1)) == 1) return true;
    usleep(20'000);
  }
  return false;
}

TEST(SocketCanFaults, AnInterfaceThatIsRemovedAndComesBack) {
  run("ip link add dev vcan7 type vcan && ip link set vcan7 mtu 72 up");
  const auto bus = open_can_bus("socketcan:vcan7", true);
  bus->set_receive_filters(std::array{exactly(0x11)});
  const int descriptor = bus->descriptor();
  run("ip link del vcan7");
  EXPECT_TRUE(is_silent(bus.get()));
  EXPECT_TRUE(bus->statistics().link_down);
  EXPECT_EQ(bus->statistics().last_errno, ENODEV);
  EXPECT_EQ(bus->send(numbered(1)), 0);
  EXPECT_EQ(bus->statistics().last_errno, ENXIO);

  run("ip link add dev vcan7 type vcan");  // there, but down
  usleep(300'000);
  EXPECT_EQ(bus->send(numbered(1)), 0);
  run("ip link set vcan7 mtu 16 up");  // up, but without FD
  usleep(300'000);
  EXPECT_EQ(bus->send(numbered(1)), 0);
  EXPECT_TRUE(bus->statistics().link_down);
  run("ip link set vcan7 down && ip link set vcan7 mtu 72 up");
  EXPECT_TRUE(sends_again(bus.get()));
  EXPECT_FALSE(bus->statistics().link_down);
  EXPECT_EQ(bus->descriptor(), descriptor);

  // With its filters, FD and error frames, as before.
  const auto other = open_can_bus("socketcan:vcan7", true);
  CanFrame fd = numbered(0x11);
  fd.fd = true;
  CanFrame error;
  error.error = true;
  error.id = CAN_ERR_BUSOFF;
  error.length = 8;
  ASSERT_EQ(other->send(std::array{numbered(0x12), fd, error}), 3);
  const auto got = receive(bus.get(), 2);
  ASSERT_EQ(got.size(), 2U);
  EXPECT_TRUE(got[0].fd);
  EXPECT_TRUE(bus->statistics().bus_off);
  EXPECT_TRUE(is_silent(bus.get()));
  run("ip link del vcan7");
}

// tbf holds back what exceeds 8 kbit/s; 80 bytes at once. What waits there has not left.
TEST(SocketCanFaults, FramesThatWaitInTheQueueAreKnown) {
  const auto a = open_can_bus("socketcan:vxcan0", true);
  const auto b = open_can_bus("socketcan:vxcan1", true);
  for (int i = 0; i < 3; ++i) a->send(numbered(1));
  EXPECT_FALSE(a->statistics().unsent);
  run("tc qdisc add dev vxcan0 root tbf rate 8kbit burst 80 limit 4000");
  for (std::uint32_t i = 0; i < 20; ++i) a->send(numbered(i));
  EXPECT_TRUE(a->statistics().unsent);
  EXPECT_EQ(receive(b.get(), 23).size(), 23U);
  EXPECT_EQ(a->send(numbered(1)), 1);
  EXPECT_FALSE(a->statistics().unsent);
  run("tc qdisc del dev vxcan0 root");
}

// --- filters and details ---

TEST(SocketCan, HearsOnlyWhatItsFiltersPass) {
  const auto a = open_can_bus("socketcan:vcan0", true);
  const auto b = open_can_bus("socketcan:vcan0", true);
  b->set_receive_filters(std::array{exactly(0x11), exactly(0x8005), CanFilter{0x03, 0x7F, false}});
  std::vector<CanFrame> sent;
  for (std::uint32_t id : {0x10U, 0x11U, 0x111U, 0x183U, 0x7FFU}) sent.push_back(numbered(id));
  for (std::uint32_t id : {0x11U, 0x8005U, 0x8006U}) {
    sent.push_back(numbered(id));
    sent.back().extended = true;
  }
  CanFrame error;
  error.error = true;
  error.id = CAN_ERR_ACK;
  error.length = 8;
  sent.push_back(error);
  ASSERT_EQ(a->send(sent), static_cast<int>(sent.size()));
  const auto got = receive(b.get(), 4);
  ASSERT_EQ(got.size(), 4U);
  EXPECT_EQ(got[0].id, 0x11U);
  EXPECT_EQ(got[1].id, 0x183U);
  EXPECT_EQ(got[2].id, 0x8005U);
  EXPECT_TRUE(got[3].error);
  EXPECT_TRUE(is_silent(b.get()));
}

TEST(SocketCan, VirtualInterfacesHaveNoBitTiming) {
  for (const char* name : {"vcan0", "vxcan0"}) {
    const auto link = read_link_details(name);
    ASSERT_TRUE(link) << name;
    EXPECT_FALSE(link->has_bit_timing());
  }
  EXPECT_EQ(read_link_details("vcan0")->kind, "vcan");
  EXPECT_FALSE(read_link_details("vcan7"));
}

TEST(SocketCanFaults, AFullTransmitQueueDropsAtOnce) {
  const auto a = open_can_bus("socketcan:vxcan0", true);
  const auto b = open_can_bus("socketcan:vxcan1", true);
  run("tc qdisc add dev vxcan0 root netem limit 10 delay 200ms");
  std::vector<CanFrame> sent;
  for (std::uint32_t id = 0; id < 40; ++id) sent.push_back(numbered(id));
  const std::int64_t before_ns = monotonic_ns();
  const int accepted = a->send(sent);
  EXPECT_LT(monotonic_ns() - before_ns, kSecond / 5) << "waited for the queue";
  EXPECT_GE(accepted, 10);
  EXPECT_LE(accepted, 12);
  EXPECT_EQ(a->statistics().send_refused, 40 - accepted);
  EXPECT_EQ(a->statistics().last_errno, ENOBUFS);
  EXPECT_FALSE(a->statistics().link_down);
  const auto got = receive(b.get(), static_cast<std::size_t>(accepted));
  ASSERT_EQ(got.size(), static_cast<std::size_t>(accepted));
  for (std::uint32_t id = 0; id < got.size(); ++id)
    EXPECT_EQ(got[id].id, id) << "the first ones are those that went out";
  EXPECT_EQ(a->send(numbered(41)), 1) << "the queue has room again";
  run("tc qdisc del dev vxcan0 root");
}

TEST(SocketCanFaults, LossesInTheReceiveQueueAreCounted) {
  const auto a = open_can_bus("socketcan:vcan0", true);
  const auto b = open_can_bus("socketcan:vcan0", true);
  std::array<CanFrame, 64> many;
  many.fill(numbered(1));
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(a->send(many), 64);
  std::int64_t got = 0;
  while (const int taken = b->receive(many)) got += taken;
  EXPECT_LT(got, 64'000);
  a->send(numbered(2));  // the kernel tells of its losses with the next frame it delivers
  got += static_cast<std::int64_t>(receive(b.get(), 1).size());
  EXPECT_EQ(got + b->statistics().overflow, 64'001);
}

TEST(SocketCanFaults, NothingAllocatesWhateverHappens) {
  const auto a = open_can_bus("socketcan:vxcan0", true);
  const auto b = open_can_bus("socketcan:vxcan1", true);
  CanBus* ends[] = {a.get(), b.get()};
  std::array<CanFrame, 64> frames;
  frames.fill(numbered(1));
  const auto cycle = [&] {
    const auto before = allocations();
    a->send(frames);
    b->send(numbered(2));
    wait_readable(ends, monotonic_ns() + kSecond / 50);
    a->receive(frames);
    b->receive(frames);
    return allocations() - before;
  };
  EXPECT_EQ(cycle(), 0);
  run("ip link set vxcan0 down");
  EXPECT_EQ(cycle(), 0);
  run("ip link set vxcan0 up");
  EXPECT_EQ(cycle(), 0);
}

// --- what cannot be opened ---

TEST(SocketCanRefusal, NoSuchInterface) {
  expect_contains(refusal("can7", true), "socketcan:can7: there is no such interface");
  expect_contains(refusal("can7", true), "sudo ip link add dev can7 type vcan");
}

TEST(SocketCanRefusal, NotACanInterface) {
  expect_contains(refusal("lo", false), "not a CAN interface");
}

TEST(SocketCanRefusal, ANameThatCannotBe) {
  expect_contains(refusal("an_interface_name_too_long", false), "1 to 15 characters");
}

TEST(SocketCanRefusal, AnInterfaceThatIsDown) {
  run("ip link add dev vcan8 type vcan");
  expect_contains(refusal("vcan8", false), "sudo ip link set vcan8 up");
  expect_contains(refusal("vcan8", false), "type can bitrate 1000000");
  run("ip link del vcan8");
}

TEST(SocketCanRefusal, FdOnAnInterfaceWithoutIt) {
  run("ip link add dev vcan8 type vcan && ip link set vcan8 mtu 16 up");
  expect_contains(refusal("vcan8", true), "no CAN-FD");
  expect_contains(refusal("vcan8", true), "mtu 72");
  EXPECT_EQ(refusal("vcan8", false), "opened");
  run("ip link del vcan8");
}

}  // namespace
}  // namespace limber::test_socketcan
