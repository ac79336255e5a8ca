// A bus that takes no frames, goes off or garbles them.
#include <gtest/gtest.h>

#include "tests/drivers/faulty_bus.h"
#include "tests/drivers/loaded_arm.h"

namespace limber::test_bus_lost {
namespace {

using loaded::kFallback;
using loaded::kFault;
using loaded::kKp50;
using loaded::kOn;
using loaded::kRequestOn;
using loaded::torque_sent;
using testing::FakeArm;
using testing::raw_command;
using testing::test_robot;

// An arm whose driver looks through a faulty bus.
struct FaultyArm : FakeArm {
  FaultyArm(const Robot& from, std::vector<BusFault> faults) : FakeArm(from) {
    bus = std::make_unique<FaultyBus>(driver_ends[0].get(), std::move(faults), 1);
    std::vector<CanBus*> ends{bus.get()};
    for (std::size_t b = 1; b < driver_ends.size(); ++b) ends.push_back(driver_ends[b].get());
    driver = std::make_unique<ArmDriver>(from, ends, ArmDriverOptions{.session = kSession});
  }
  std::unique_ptr<FaultyBus> bus;
};

TEST(BusTest, AFullQueueDropsTheFrameAndTheNextCycleSendsANewerOne) {
  BusFault full{.kind = BusFault::Kind::kRefuse, .direction = BusFault::Direction::kSent};
  full.active = false;
  FaultyArm arm(test_robot(2), {full});
  ASSERT_TRUE(arm.switch_on());
  for (int refused = 1; refused <= 2; ++refused) {
    arm.bus->set_active(0, true);
    const std::size_t before = arm.motors[0].frames.size();
    for (int i = 0; i < refused; ++i) arm.cycle_with(kRequestOn);
    arm.bus->set_active(0, false);
    arm.command.tau[0] = 0.1 * refused;
    arm.cycle_with(kRequestOn);
    arm.cycle_with(kRequestOn);
    EXPECT_EQ(arm.motors[0].frames.size(), before + 2);  // nothing was queued
    EXPECT_NEAR(torque_sent(arm, 0), 0.1 * refused, 5e-3);
    EXPECT_EQ(arm.state->drive_state, kOn);
  }
  EXPECT_EQ(arm.read_status().send_refused[0], 6);
}

TEST(BusTest, RefusedInThreeCyclesIsABusFault) {
  BusFault full{.kind = BusFault::Kind::kRefuse, .direction = BusFault::Direction::kSent};
  full.active = false;
  FaultyArm arm(test_robot(4, 2), {full});
  ASSERT_TRUE(arm.switch_on());
  arm.bus->set_active(0, true);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(arm.state->drive_state, kOn);
    arm.cycle_with(kRequestOn);
  }
  EXPECT_EQ(arm.state->drive_state, kFallback);  // the joints on the other bus are held
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_BUS + 0);
  for (int i = 0; i < 110; ++i) arm.cycle_with(kRequestOn);
  EXPECT_EQ(raw_command(arm.motors[1].last()).kp, kKp50);
}

TEST(BusTest, BusOffOfTheOnlyBusIsAFault) {
  BusFault off{.kind = BusFault::Kind::kBusOff};
  off.active = false;
  FaultyArm arm(test_robot(2), {off});
  ASSERT_TRUE(arm.switch_on());
  arm.bus->set_active(0, true);
  arm.cycle_with(kRequestOn);
  EXPECT_NE(arm.state->drive_state, kOn);
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_BUS + 0);
  for (int i = 0; i < 20; ++i) arm.cycle_with(kRequestOn);
  EXPECT_EQ(arm.state->drive_state, kFault);
}

TEST(BusTest, CorruptedAndDuplicatedRepliesDoNotCount) {
  BusFault flip{.kind = BusFault::Kind::kCorrupt};
  flip.id = 0x11;
  flip.id_mask = 0x7FF;
  flip.byte = 1;
  flip.flip = 0x40;  // 16384 counts: 6 rad
  flip.probability = 0.005;
  BusFault twice{.kind = BusFault::Kind::kDuplicate};
  FaultyArm arm(test_robot(2), {flip, twice});
  ASSERT_TRUE(arm.switch_on());
  for (int i = 0; i < 1000; ++i) {
    arm.cycle_with(kRequestOn);
    ASSERT_NEAR(arm.state->q[0], 0.0, 4e-4);
  }
  EXPECT_GT(arm.bus->hits(0), 0);
  EXPECT_GT(arm.read_status().replies_invalid[1], 900);  // each second copy
}

}  // namespace
}  // namespace limber::test_bus_lost
