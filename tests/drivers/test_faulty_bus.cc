#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "drivers/can/memory_bus.h"
#include "tests/drivers/faulty_bus.h"
#include "tools/allocations/allocations.h"

namespace limber::test_faulty_bus {
namespace {

using Kind = BusFault::Kind;
using Direction = BusFault::Direction;
using Ids = std::vector<std::uint32_t>;

CanFrame numbered(std::uint32_t id) {
  CanFrame frame;
  frame.id = id;
  frame.length = 4;
  frame.data[2] = 0x5A;
  return frame;
}

Ids ids(CanBus* end) {
  std::vector<CanFrame> frames(256);
  frames.resize(static_cast<std::size_t>(end->receive(frames)));
  Ids result;
  for (const CanFrame& frame : frames) result.push_back(frame.id);
  return result;
}

/// A faulty end and a sound one.
struct Pair {
  explicit Pair(std::vector<BusFault> faults, std::uint64_t seed = 1)
      : faulty(below.get(), std::move(faults), seed) {}
  MemoryBus bus{4096};
  std::unique_ptr<CanBus> below = bus.attach();
  std::unique_ptr<CanBus> sound = bus.attach();
  FaultyBus faulty;
};

BusFault fault(Kind kind, Direction direction, std::uint32_t id = 0, std::uint32_t mask = 0) {
  BusFault result;
  result.kind = kind;
  result.direction = direction;
  result.id = id;
  result.id_mask = mask;
  return result;
}

TEST(FaultyBus, WithoutFaultsIsTheBusBelow) {
  Pair pair({});
  pair.sound->send(std::array{numbered(1), numbered(2)});
  EXPECT_EQ(ids(&pair.faulty), Ids({1, 2}));
  EXPECT_EQ(pair.faulty.send(numbered(3)), 1);
  EXPECT_EQ(ids(pair.sound.get()), Ids({3}));
  EXPECT_EQ(pair.faulty.statistics().received, 2);
  EXPECT_EQ(pair.faulty.statistics().sent, 1);
  EXPECT_EQ(pair.faulty.descriptor(), -1);
}

TEST(FaultyBus, DropsByIdentifierAndDirection) {
  Pair pair({fault(Kind::kDrop, Direction::kReceived, 0x10, 0x7F0),
             fault(Kind::kDrop, Direction::kSent, 3, 0x7FF)});
  pair.sound->send(std::array{numbered(3), numbered(0x13), numbered(0x1F), numbered(0x20)});
  EXPECT_EQ(ids(&pair.faulty), Ids({3, 0x20}));
  EXPECT_EQ(pair.faulty.hits(0), 2);
  EXPECT_EQ(pair.faulty.send(std::array{numbered(3), numbered(4)}), 2)
      << "the sender of a lost frame knows nothing";
  EXPECT_EQ(ids(pair.sound.get()), Ids({4}));
}

TEST(FaultyBus, ProbabilityIsASeededShare) {
  const auto run = [](std::uint64_t seed) {
    BusFault drop = fault(Kind::kDrop, Direction::kReceived);
    drop.probability = 0.25;
    Pair pair({drop}, seed);
    for (std::uint32_t id = 0; id < 2000; ++id) pair.sound->send(numbered(id));
    Ids all;
    for (Ids some = ids(&pair.faulty); !some.empty(); some = ids(&pair.faulty))
      all.insert(all.end(), some.begin(), some.end());
    return all;
  };
  const Ids got = run(1);
  // Binomial: 1500 expected, sigma = sqrt(2000 * 0.25 * 0.75) = 19.4.
  EXPECT_NEAR(static_cast<double>(got.size()), 1500.0, 5 * 19.4);
  EXPECT_EQ(run(1), got) << "same seed, same losses";
  EXPECT_NE(run(2), got);
}

TEST(FaultyBus, DelaysByCallsAndLetsOthersOvertake) {
  BusFault delay = fault(Kind::kDelay, Direction::kReceived, 1, 0x7FF);
  delay.delay_calls = 2;
  Pair pair({delay});
  pair.sound->send(std::array{numbered(1), numbered(2)});
  EXPECT_EQ(ids(&pair.faulty), Ids({2}));
  pair.sound->send(numbered(3));
  EXPECT_EQ(ids(&pair.faulty), Ids({3}));
  EXPECT_EQ(ids(&pair.faulty), Ids({1}));
  EXPECT_EQ(ids(&pair.faulty), Ids());
}

TEST(FaultyBus, HandsOutAtMostWhatIsAskedForAndKeepsTheRest) {
  Pair pair({});
  for (std::uint32_t id = 1; id <= 3; ++id) pair.sound->send(numbered(id));
  std::array<CanFrame, 2> two;
  ASSERT_EQ(pair.faulty.receive(two), 2);
  EXPECT_EQ(two[1].id, 2U);
  EXPECT_EQ(ids(&pair.faulty), Ids({3}));
}

TEST(FaultyBus, CorruptsOneByte) {
  BusFault corrupt = fault(Kind::kCorrupt, Direction::kReceived);
  corrupt.byte = 2;
  corrupt.flip = 0xFF;
  BusFault beyond = corrupt;
  beyond.byte = 4;
  Pair pair({corrupt, beyond});
  pair.sound->send(numbered(1));
  CanFrame got;
  ASSERT_EQ(pair.faulty.receive(std::span(&got, 1)), 1);
  EXPECT_EQ(got.data[2], 0xA5);
  EXPECT_EQ(got.data[4], 0x00) << "behind the end of the frame there is nothing to corrupt";
}

TEST(FaultyBus, Duplicates) {
  Pair pair({fault(Kind::kDuplicate, Direction::kReceived, 1, 0x7FF),
             fault(Kind::kDuplicate, Direction::kSent)});
  pair.sound->send(std::array{numbered(1), numbered(2)});
  EXPECT_EQ(ids(&pair.faulty), Ids({1, 1, 2}));
  EXPECT_EQ(pair.faulty.send(numbered(5)), 1);
  EXPECT_EQ(ids(pair.sound.get()), Ids({5, 5}));
}

TEST(FaultyBus, RefusesToSend) {
  Pair pair({fault(Kind::kRefuse, Direction::kSent, 2, 0x7FF)});
  EXPECT_EQ(pair.faulty.send(std::array{numbered(1), numbered(2), numbered(3)}), 2);
  EXPECT_EQ(pair.faulty.statistics().send_refused, 1);
  EXPECT_EQ(ids(pair.sound.get()), Ids({1, 3}));
}

TEST(FaultyBus, BusOffComesAndGoes) {
  BusFault off = fault(Kind::kBusOff, Direction::kSent);
  off.active = false;
  Pair pair({off});
  EXPECT_EQ(pair.faulty.send(numbered(1)), 1);
  EXPECT_FALSE(pair.faulty.statistics().bus_off);
  pair.faulty.set_active(0, true);
  pair.sound->send(numbered(9));
  EXPECT_EQ(pair.faulty.send(numbered(2)), 0);
  EXPECT_EQ(ids(&pair.faulty), Ids());
  EXPECT_TRUE(pair.faulty.statistics().bus_off);
  pair.faulty.set_active(0, false);
  EXPECT_EQ(ids(&pair.faulty), Ids()) << "what was sent meanwhile is gone";
  EXPECT_EQ(pair.faulty.send(numbered(3)), 1);
  EXPECT_EQ(ids(pair.sound.get()), Ids({1, 3}));
  EXPECT_FALSE(pair.faulty.statistics().bus_off);
}

TEST(FaultyBus, DoesNotAllocateAfterConstruction) {
  BusFault delay = fault(Kind::kDelay, Direction::kReceived);
  delay.delay_calls = 5;
  Pair pair({delay, fault(Kind::kDuplicate, Direction::kReceived)});
  std::array<CanFrame, 8> frames;
  frames.fill(numbered(1));
  const auto before = allocations();
  for (int i = 0; i < 200; ++i) {
    pair.sound->send(frames);
    pair.faulty.send(frames);
    pair.faulty.receive(frames);
  }
  EXPECT_EQ(allocations(), before);
}

}  // namespace
}  // namespace limber::test_faulty_bus
