// A queue that is too short, or not emptied: who is sent first, and when that counts as lost. How
// often a bus is asked for what has arrived.
#include <gtest/gtest.h>

#include "drivers/drive/bus_end.h"

namespace limber::test_bus_end {
namespace {

using Ids = std::vector<std::uint32_t>;

/// Takes so many frames a batch.
class ShortQueue final : public CanBus {
 public:
  using CanBus::send;
  int send(std::span<const CanFrame> frames) noexcept override {
    taken.clear();
    for (const CanFrame& frame : frames) {
      if (taken.size() < room) taken.push_back(frame.id);
    }
    return static_cast<int>(taken.size());
  }
  int receive(std::span<CanFrame> frames) noexcept override {
    ++receive_calls;
    const std::size_t count = std::min(frames.size(), waiting);
    waiting -= count;
    std::fill_n(frames.begin(), count, CanFrame{});
    return static_cast<int>(count);
  }
  int descriptor() const noexcept override { return -1; }
  const CanStatistics& statistics() const noexcept override { return statistics_; }

  std::size_t room = 100;
  std::size_t waiting = 0;
  int receive_calls = 0;
  Ids taken;
  CanStatistics statistics_;
};

CanFrame frame(std::uint32_t id) {
  CanFrame made;
  made.id = id;
  return made;
}

/// What gets through of a cycle's commands 1, 2, ...
Ids cycle(BusEnd* end, const ShortQueue& bus, std::uint32_t commands) {
  end->clear();
  for (std::uint32_t id = 1; id <= commands; ++id) end->add(frame(id));
  end->send();
  return bus.taken;
}

TEST(BusEnd, TheOrderIsThatOfTheJointsAsLongAsAllIsTaken) {
  ShortQueue bus;
  BusEnd end(&bus, {}, 0.0);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(cycle(&end, bus, 4), Ids({1, 2, 3, 4}));
}

TEST(BusEnd, AShortQueueServesEveryMotorInTurn) {
  ShortQueue bus;
  BusEnd end(&bus, {}, 0.0);
  bus.room = 2;
  EXPECT_EQ(cycle(&end, bus, 5), Ids({1, 2}));
  EXPECT_EQ(cycle(&end, bus, 5), Ids({3, 4}));
  EXPECT_EQ(cycle(&end, bus, 5), Ids({5, 1}));
  EXPECT_EQ(cycle(&end, bus, 5), Ids({2, 3}));
  bus.room = 100;
  EXPECT_EQ(cycle(&end, bus, 5), Ids({4, 5, 1, 2, 3}));
  EXPECT_EQ(cycle(&end, bus, 5), Ids({1, 2, 3, 4, 5}));
}

TEST(BusEnd, AFullQueueTakesNoneAndTheOrderStays) {
  ShortQueue bus;
  BusEnd end(&bus, {}, 0.0);
  bus.room = 0;
  for (int i = 0; i < 3; ++i) EXPECT_EQ(cycle(&end, bus, 3), Ids());
  EXPECT_EQ(end.state(), +driver_status_t::BUS_QUEUE_FULL);
  bus.room = 100;
  EXPECT_EQ(cycle(&end, bus, 3), Ids({1, 2, 3}));
  EXPECT_EQ(end.state(), +driver_status_t::BUS_GOOD);
}

TEST(BusEnd, TheSyncStaysBehindTheCommands) {
  ShortQueue bus;
  BusEnd end(&bus, {}, 0.0);
  end.end_with(frame(0x80));
  bus.room = 2;
  EXPECT_EQ(cycle(&end, bus, 3), Ids({1, 2}));
  bus.room = 100;
  EXPECT_EQ(cycle(&end, bus, 3), Ids({3, 1, 2, 0x80}));
  bus.room = 3;  // all but the SYNC
  EXPECT_EQ(cycle(&end, bus, 3), Ids({1, 2, 3}));
  EXPECT_EQ(cycle(&end, bus, 3), Ids({1, 2, 3}));
}

TEST(BusEnd, FramesThatWaitInTheQueueForThreeCyclesAreALostBus) {
  ShortQueue bus;
  BusEnd end(&bus, {}, 0.0);
  bus.statistics_.unsent = true;
  for (int i = 0; i < 2; ++i) {
    cycle(&end, bus, 3);
    EXPECT_FALSE(end.lost());
  }
  bus.statistics_.unsent = false;
  cycle(&end, bus, 3);
  bus.statistics_.unsent = true;
  for (int i = 0; i < 3; ++i) cycle(&end, bus, 3);
  EXPECT_EQ(end.state(), +driver_status_t::BUS_QUEUE_FULL);
}

TEST(BusEnd, ABatchThatIsNotFullWasTheLast) {
  for (const std::size_t arrived : {0U, 7U, 32U, 33U, 71U}) {
    ShortQueue bus;
    BusEnd end(&bus, {}, 0.0);
    bus.waiting = arrived;
    std::size_t taken = 0;
    do {
      taken += end.receive(0).size();
    } while (end.more());
    EXPECT_EQ(taken, arrived);
    EXPECT_EQ(bus.receive_calls, static_cast<int>(arrived / 32 + 1));  // one for seven replies
  }
}

}  // namespace
}  // namespace limber::test_bus_end
