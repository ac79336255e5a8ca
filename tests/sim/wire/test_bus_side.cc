// One bus of the simulated arm, between the driver's adapter and the nodes.
#include <gtest/gtest.h>

#include <array>
#include <memory>

#include "drivers/can/memory_bus.h"
#include "sim/wire/bus_side.h"

namespace limber::sim::test_bus_side {
namespace {

struct Times {
  std::int64_t at_node_ns = 0;
  std::int64_t at_driver_ns = 0;
};

/// A command that the driver sends at 0, and its reply, at an adapter whose jitter is the same each
/// time.
Times exchange(double delay_s, CanAdapter adapter) {
  MemoryBus bus;
  const std::unique_ptr<CanBus> nodes = bus.attach();
  const std::unique_ptr<CanBus> driver = bus.attach();
  BusConfig config{"arm", "virtual:test", false, 1'000'000, 1'000'000};
  config.adapter = adapter;
  BusSide side(nodes.get(), config, {.on = true, .delay_s = delay_s}, 1, 0);
  CanFrame frame;
  frame.id = 0x555;
  constexpr std::int64_t kLong_ns = 100'000'000;
  side.accept(frame, 0);
  Times times;
  EXPECT_TRUE(side.carry(kLong_ns, 0, &frame, &times.at_node_ns));
  side.send(0, frame, times.at_node_ns);
  EXPECT_FALSE(side.carry(kLong_ns, 0, &frame, &times.at_driver_ns));
  side.deliver();
  std::array<CanFrame, 2> replies;
  EXPECT_EQ(driver->receive(replies), 1);
  times.at_driver_ns = replies[0].timestamp_ns;
  return times;
}

TEST(BusSide, AFrameTakesTheDelayOfTheScenarioEachWay) {
  for (const CanAdapter adapter : {CanAdapter::kNative, CanAdapter::kSlcan}) {
    const Times plain = exchange(0.0, adapter);
    const Times late = exchange(250e-6, adapter);
    EXPECT_GT(plain.at_node_ns, 47'000) << "its bits";
    EXPECT_EQ(late.at_node_ns - plain.at_node_ns, 250'000);
    EXPECT_EQ(late.at_driver_ns - plain.at_driver_ns, 500'000);
  }
}

}  // namespace
}  // namespace limber::sim::test_bus_side
