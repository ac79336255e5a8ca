// Waiting for the motors, and counting cycles that were too long.
#include <gtest/gtest.h>

#include <deque>

#include "drivers/overrun_watch.h"
#include "drivers/roll_call.h"
#include "tests/drivers/driver/fake_arm.h"

namespace limber {
namespace {

/// A bus whose motors answer at once; the first `deaf` questions are lost.
class PromptBus : public CanBus {
 public:
  using CanBus::send;
  PromptBus(const Robot& robot, int deaf) : deaf_(deaf) {
    for (const JointConfig& joint : robot.joints) motors.emplace_back(joint.drive);
  }
  int send(std::span<const CanFrame> frames) noexcept override {
    for (const CanFrame& frame : frames) {
      CanFrame reply;
      for (testing::FakeMotor& motor : motors) {
        if (motor.handle(frame, &reply) && --deaf_ < 0) replies_.push_back(reply);
      }
    }
    return static_cast<int>(frames.size());
  }
  int receive(std::span<CanFrame> frames) noexcept override {
    if (replies_.empty()) return 0;
    frames[0] = replies_.front();
    replies_.pop_front();
    return 1;
  }
  int descriptor() const noexcept override { return -1; }
  const CanStatistics& statistics() const noexcept override { return statistics_; }

  std::vector<testing::FakeMotor> motors;

 private:
  int deaf_;
  std::deque<CanFrame> replies_;
  CanStatistics statistics_;
};

TEST(RollCallTest, AsksOnlyForARegisterAndUntilEverybodyIsHere) {
  const Robot robot = testing::test_robot(3);
  PromptBus bus(robot, 2);  // two of the first three questions are lost
  std::vector<CanBus*> buses{&bus};
  volatile std::sig_atomic_t stop = 0;
  EXPECT_EQ(call_roll(robot, buses, 5.0, stop), "");
  std::size_t asked = 0;
  for (const testing::FakeMotor& motor : bus.motors) {
    asked += motor.frames.size();
    for (const CanFrame& frame : motor.frames) {
      EXPECT_EQ(frame.id, 0x7FFU);
      EXPECT_EQ(frame.data[2], 0x33);  // reads
    }
  }
  EXPECT_EQ(asked, 5U);
}

TEST(RollCallTest, NamesWhoIsMissing) {
  Robot robot = testing::test_robot(3);
  robot.buses[0].can = "virtual:test";
  PromptBus bus(robot, 0);
  bus.motors[1].silent = true;
  std::vector<CanBus*> buses{&bus};
  volatile std::sig_atomic_t stop = 0;
  EXPECT_EQ(call_roll(robot, buses, 0.15, stop), "joint2 (id 0x2 on virtual:test)");
  stop = 1;
  EXPECT_NE(call_roll(robot, buses, 1000.0, stop), "");  // returns at once
}

TEST(OverrunWatchTest, ThreeInARow) {
  OverrunWatch watch(1000);
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(watch.too_many(true));
    EXPECT_FALSE(watch.too_many(true));
    EXPECT_FALSE(watch.too_many(false));
  }
  EXPECT_FALSE(watch.too_many(true));
  EXPECT_FALSE(watch.too_many(true));
  EXPECT_TRUE(watch.too_many(true));
  EXPECT_EQ(watch.count(), 9);
}

TEST(OverrunWatchTest, TenWithinASecond) {
  for (int gap : {110, 112}) {  // the tenth in the 991st or the 1009th cycle
    OverrunWatch watch(1000);
    bool tripped = false;
    for (int overrun = 1; overrun <= 10; ++overrun) {
      tripped = watch.too_many(true);
      EXPECT_FALSE(tripped && overrun < 10);
      for (int i = 1; i < gap; ++i) EXPECT_FALSE(watch.too_many(false));
    }
    EXPECT_EQ(tripped, gap == 110);
  }
}

}  // namespace
}  // namespace limber
