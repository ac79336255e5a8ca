// The emergency stop on the bus: pressed, silent, and completed once begun.
#include <gtest/gtest.h>

#include "drivers/drive/emergency_stop_link.h"

namespace limber::test_emergency_stop_link {
namespace {

constexpr std::int8_t kReleased = joint_state_t::STOP_RELEASED;
constexpr std::int8_t kPressed = joint_state_t::STOP_PRESSED;
constexpr std::int8_t kSilent = joint_state_t::STOP_SILENT;

/// Id 0x185 on bus 1, bit 2 of byte 1; 20 cycles of silence, 50 until the power goes.
class EmergencyStopTest : public ::testing::Test {
 protected:
  EmergencyStopTest() : link_({1, 0x185, 1, 0x04, 0x04, 0.02, 0.05}, 1000.0) {}

  static CanFrame frame(int byte1, int length = 2) {
    CanFrame frame;
    frame.id = 0x185;
    frame.length = static_cast<std::uint8_t>(length);
    frame.data[1] = static_cast<std::uint8_t>(byte1);
    return frame;
  }
  void cycle(const CanFrame& heard) {
    link_.receive(heard);
    link_.close_cycle();
  }

  EmergencyStopLink link_;
};

TEST_F(EmergencyStopTest, KnowsItsFrame) {
  EXPECT_TRUE(link_.is_mine(1, frame(0)));
  EXPECT_FALSE(link_.is_mine(0, frame(0)));
  CanFrame other = frame(0);
  other.id = 0x186;
  EXPECT_FALSE(link_.is_mine(1, other));
}

TEST_F(EmergencyStopTest, OnlyTheMaskedBitCounts) {
  cycle(frame(0x04));
  EXPECT_EQ(link_.state(), kReleased);
  cycle(frame(0xFF));
  EXPECT_FALSE(link_.stopped());
  cycle(frame(0xFB));
  EXPECT_TRUE(link_.stopped());
  EXPECT_EQ(link_.state(), kPressed);
}

TEST_F(EmergencyStopTest, SilenceIsAStopAlsoAtTheStart) {
  for (int i = 0; i < 20; ++i) link_.close_cycle();
  EXPECT_EQ(link_.state(), kReleased);
  link_.close_cycle();
  EXPECT_EQ(link_.state(), kSilent);
  EXPECT_TRUE(link_.stopped());
  cycle(frame(0x04, 1));  // too short: tells nothing
  EXPECT_EQ(link_.state(), kSilent);
}

TEST_F(EmergencyStopTest, AStopThatWasBegunIsCompleted) {
  cycle(frame(0x00));
  for (int i = 1; i < 50; ++i) cycle(frame(0x04));
  EXPECT_TRUE(link_.stopped());
  EXPECT_FALSE(link_.power_is_off());
  cycle(frame(0x04));
  EXPECT_TRUE(link_.power_is_off());
  cycle(frame(0x04));
  EXPECT_FALSE(link_.stopped()) << "released, and the power has been off";
}

TEST_F(EmergencyStopTest, SilenceIsCountedFromTheLastFrame) {
  for (int i = 0; i < 15; ++i) link_.close_cycle();
  cycle(frame(0x04));
  for (int i = 1; i < 20; ++i) link_.close_cycle();
  EXPECT_EQ(link_.state(), kReleased);
  link_.close_cycle();
  EXPECT_EQ(link_.state(), kSilent);
}

// Half a cycle at 100 Hz: a frame that is awaited for a cycle is not missing yet.
TEST(EmergencyStop, ASlowCycleIsWaitedForOnce) {
  EmergencyStopLink link({1, 0x185, 1, 0x04, 0x04, 0.005, 0.0}, 100.0);
  EXPECT_FALSE(link.power_is_off()) << "also where it goes at once";
  link.close_cycle();
  EXPECT_FALSE(link.stopped());
  link.close_cycle();
  EXPECT_EQ(link.state(), kSilent);
  EXPECT_TRUE(link.power_is_off());
}

TEST_F(EmergencyStopTest, OnlyItsBusNeedsItsFrames) {
  std::vector<CanFilter> filters;
  link_.add_receive_filters(0, &filters);
  EXPECT_TRUE(filters.empty());
  link_.add_receive_filters(1, &filters);
  ASSERT_EQ(filters.size(), 1u);
  EXPECT_EQ(filters[0].id, 0x185u);
}

TEST_F(EmergencyStopTest, WhilePressedThePowerStaysOff) {
  for (int i = 0; i < 51; ++i) cycle(frame(0x00));
  for (int i = 0; i < 500; ++i) {
    EXPECT_TRUE(link_.power_is_off()) << i;
    cycle(frame(0x00));
  }
}

}  // namespace
}  // namespace limber::test_emergency_stop_link
