#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "drivers/can/memory_bus.h"
#include "tools/allocations/allocations.h"

namespace limber::test_memory_bus {
namespace {

CanFrame numbered(std::uint32_t id) {
  CanFrame frame;
  frame.id = id;
  frame.length = 2;
  frame.data[0] = static_cast<std::uint8_t>(id);
  frame.timestamp_ns = 1000 + id;
  return frame;
}

std::vector<std::uint32_t> ids(CanBus* end, std::size_t at_most = 64) {
  std::vector<CanFrame> frames(at_most);
  frames.resize(static_cast<std::size_t>(end->receive(frames)));
  std::vector<std::uint32_t> result;
  for (const CanFrame& frame : frames) result.push_back(frame.id);
  return result;
}

using Ids = std::vector<std::uint32_t>;

TEST(MemoryBus, EveryOtherEndHearsFramesInOrderAndTheSenderDoesNot) {
  MemoryBus bus;
  const auto a = bus.attach();
  const auto b = bus.attach();
  const auto c = bus.attach();
  EXPECT_EQ(a->send(std::array{numbered(1), numbered(2)}), 2);
  EXPECT_EQ(b->send(numbered(3)), 1);
  EXPECT_EQ(ids(a.get()), Ids({3}));
  EXPECT_EQ(ids(b.get()), Ids({1, 2}));
  EXPECT_EQ(ids(c.get()), Ids({1, 2, 3}));
  EXPECT_TRUE(ids(c.get()).empty());
}

TEST(MemoryBus, CarriesTheFrameWhole) {
  MemoryBus bus;
  const auto a = bus.attach();
  const auto b = bus.attach();
  CanFrame sent = numbered(7);
  sent.extended = sent.fd = sent.bitrate_switch = true;
  sent.length = 64;
  sent.data[63] = 0xAB;
  a->send(sent);
  CanFrame got;
  ASSERT_EQ(b->receive(std::span(&got, 1)), 1);
  EXPECT_EQ(got.id, 7U);
  EXPECT_TRUE(got.extended && got.fd && got.bitrate_switch);
  EXPECT_EQ(got.length, 64);
  EXPECT_EQ(got.data, sent.data);
  EXPECT_EQ(got.timestamp_ns, 1007) << "simulated time must come through";
}

TEST(MemoryBus, AFullQueueDropsTheNewFrameAndCountsIt) {
  MemoryBus bus(3);
  const auto a = bus.attach();
  const auto b = bus.attach();
  for (std::uint32_t id = 1; id <= 5; ++id) EXPECT_EQ(a->send(numbered(id)), 1);
  EXPECT_EQ(ids(b.get()), Ids({1, 2, 3}));
  EXPECT_EQ(b->statistics().overflow, 2);
  EXPECT_EQ(b->statistics().received, 3);
  EXPECT_EQ(a->statistics().sent, 5);
  a->send(numbered(6));
  EXPECT_EQ(ids(b.get()), Ids({6})) << "the queue is usable again";
}

TEST(MemoryBus, HandsOutAtMostWhatIsAskedFor) {
  MemoryBus bus;
  const auto a = bus.attach();
  const auto b = bus.attach();
  for (std::uint32_t id = 1; id <= 5; ++id) a->send(numbered(id));
  EXPECT_EQ(ids(b.get(), 2), Ids({1, 2}));
  EXPECT_EQ(ids(b.get(), 2), Ids({3, 4}));
  EXPECT_EQ(ids(b.get(), 0), Ids());
  EXPECT_EQ(ids(b.get(), 2), Ids({5}));
}

TEST(MemoryBus, RefusesAFrameThatNoBusCouldCarry) {
  MemoryBus bus;
  const auto a = bus.attach();
  const auto b = bus.attach();
  EXPECT_EQ(a->send(std::array{numbered(0x800), numbered(1)}), 1);
  EXPECT_EQ(a->statistics().send_refused, 1);
  EXPECT_EQ(ids(b.get()), Ids({1}));
}

TEST(MemoryBus, AnEndThatHasGoneHearsNothing) {
  MemoryBus bus;
  const auto a = bus.attach();
  { const auto gone = bus.attach(); }
  EXPECT_EQ(a->send(numbered(1)), 1);
}

TEST(MemoryBus, DoesNotAllocateOnceAttached) {
  MemoryBus bus(8);
  const auto a = bus.attach();
  const auto b = bus.attach();
  std::array<CanFrame, 8> frames;
  const auto before = allocations();
  for (int i = 0; i < 100; ++i) {
    a->send(numbered(1));
    b->send(numbered(2));
    a->receive(frames);
    b->receive(frames);
  }
  EXPECT_EQ(allocations(), before);
}

}  // namespace
}  // namespace limber::test_memory_bus
