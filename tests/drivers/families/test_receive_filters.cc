// Receive filters pass all that the driver must hear, and little else.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "drivers/can/lockstep_frame.h"
#include "drivers/families/drive_family.h"
#include "robots/loader/protocols/drive_protocol.h"
#include "tests/drivers/families/fake_cia402.h"

namespace limber::test_receive_filters {
namespace {

bool passes(const std::vector<CanFilter>& filters, const CanFrame& frame) {
  return std::ranges::any_of(filters, [&](const CanFilter& f) { return f.passes(frame); });
}

CanFrame with_id(std::uint32_t id, bool extended) {
  CanFrame frame;
  frame.id = id;
  frame.extended = extended;
  frame.length = 8;
  return frame;
}

std::vector<CanFrame> every_kind_of_id() {
  std::vector<CanFrame> frames;
  for (std::uint32_t id = 0; id <= kStandardIdMax; ++id) frames.push_back(with_id(id, false));
  for (std::uint32_t id = 0; id <= 0xFFFF; ++id) frames.push_back(with_id(id, true));
  std::mt19937 random(1);
  for (int i = 0; i < 50'000; ++i) frames.push_back(with_id(random() & kExtendedIdMax, true));
  return frames;
}

Robot moteus_robot() {
  Robot robot = testing::test_robot(3);
  for (std::uint32_t i = 0; i < 3; ++i) {
    robot.joints[i].drive.protocol = &protocol_named("moteus");
    robot.joints[i].drive.command_id = 0x8000U | (i + 5);
    robot.joints[i].drive.reply_id = (i + 5) << 8U;
  }
  return robot;
}

TEST(ReceiveFilters, HoldsAllThatIsADrivesOwnOrAnOrderToIt) {
  const std::vector<CanFrame> frames = every_kind_of_id();
  for (const Robot& robot : {testing::test_robot(3), moteus_robot(), testing::cia402_robot()}) {
    for (const JointConfig& joint : robot.joints) {
      const auto family = make_drive_family(joint, true, 1e-3);
      const std::vector<CanFilter> filters = family.codec->receive_filters();
      for (const CanFrame& frame : frames) {
        const bool wanted =
            family.codec->is_mine(frame) || family.intruders->is_foreign_command(frame);
        ASSERT_TRUE(!wanted || passes(filters, frame)) << std::hex << frame.id;
      }
    }
  }
}

/// 11-bit identifiers that pass.
std::vector<std::uint32_t> filtered_ids(const Robot& robot) {
  std::vector<std::uint32_t> ids;
  const std::vector<CanFilter> filters =
      make_drive_family(robot.joints[0], true, 1e-3).codec->receive_filters();
  for (std::uint32_t id = 0; id <= kStandardIdMax; ++id) {
    if (passes(filters, with_id(id, false))) ids.push_back(id);
  }
  return ids;
}

TEST(ReceiveFilters, OfADamiaoDriveAreReplyCommandAndRegisters) {
  EXPECT_EQ(filtered_ids(testing::test_robot(1)),
            std::vector<std::uint32_t>({0x001, 0x011, 0x7FF}));
}

// Node 3: NMT, SYNC, and sixteen times its number.
TEST(ReceiveFilters, OfACanopenDriveAreItsNodeNumberSyncAndNetworkManagement) {
  const std::vector<std::uint32_t> ids = filtered_ids(testing::cia402_robot());
  EXPECT_EQ(ids.size(), 18U);
  for (std::uint32_t id : ids) EXPECT_TRUE(id == 0 || id == 0x80 || id % 128 == 3) << id;
}

/// Remembers what it was asked to pass.
class RememberingBus final : public CanBus {
 public:
  using CanBus::send;
  int send(std::span<const CanFrame> frames) noexcept override {
    return static_cast<int>(frames.size());
  }
  int receive(std::span<CanFrame> /*frames*/) noexcept override { return 0; }
  int descriptor() const noexcept override { return -1; }
  const CanStatistics& statistics() const noexcept override { return statistics_; }
  void set_receive_filters(std::span<const CanFilter> wanted) override {
    filters.assign(wanted.begin(), wanted.end());
  }
  std::vector<CanFilter> filters;
  CanStatistics statistics_;
};

TEST(ReceiveFilters, EachBusHearsItsOwnJoints) {
  const Robot robot = testing::test_robot(3, 2);  // joints 1 and 3, joint 2
  for (bool lockstep : {false, true}) {
    RememberingBus a;
    RememberingBus b;
    ArmDriver driver(robot, {&a, &b}, ArmDriverOptions{1, lockstep});
    driver.set_receive_filters();
    for (std::uint32_t id : {0x1U, 0x11U, 0x3U, 0x13U})
      EXPECT_TRUE(passes(a.filters, with_id(id, false)));
    for (std::uint32_t id : {0x2U, 0x12U}) {
      EXPECT_FALSE(passes(a.filters, with_id(id, false)));
      EXPECT_TRUE(passes(b.filters, with_id(id, false)));
    }
    EXPECT_EQ(passes(b.filters, lockstep::tock(1)), lockstep);
  }
}

TEST(ReceiveFilters, TheTipSensorToo) {
  Robot robot = testing::test_robot(1);
  robot.has_tip_sensor = true;
  robot.tip_sensor.reply_ids = {0x65, 0x66};
  RememberingBus bus;
  ArmDriver driver(robot, {&bus}, {});
  driver.set_receive_filters();
  EXPECT_TRUE(passes(bus.filters, with_id(0x65, false)));
}

}  // namespace
}  // namespace limber::test_receive_filters
