// Waiting for the motors before the first cycle.
#include <gtest/gtest.h>

#include <deque>

#include "drivers/drive/drive_discovery.h"
#include "tests/drivers/fake_arm.h"

namespace limber::test_drive_discovery {
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

TEST(DriveDiscoveryTest, AsksOnlyForARegisterAndUntilEverybodyIsHere) {
  const Robot robot = testing::test_robot(3);
  PromptBus bus(robot, 2);  // two of the first three questions are lost
  std::vector<CanBus*> buses{&bus};
  volatile std::sig_atomic_t stop = 0;
  EXPECT_EQ(discover_drives(robot, buses, false, 5.0, stop), "");
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

TEST(DriveDiscoveryTest, NamesWhoIsMissing) {
  Robot robot = testing::test_robot(3);
  robot.buses[0].can = "virtual:test";
  PromptBus bus(robot, 0);
  bus.motors[1].silent = true;
  std::vector<CanBus*> buses{&bus};
  volatile std::sig_atomic_t stop = 0;
  EXPECT_EQ(discover_drives(robot, buses, false, 0.15, stop), "joint2 (id 0x2 on virtual:test)");
  stop = 1;
  EXPECT_NE(discover_drives(robot, buses, false, 1000.0, stop), "");  // returns at once
}

// 1.5 s, 3 s: it is told at the first, and not again.
TEST(DriveDiscoveryTest, WhoIsMissingIsToldWhileTheWaitingGoesOn) {
  Robot robot = testing::test_robot(3);
  robot.buses[0].can = "virtual:test";
  PromptBus bus(robot, 0);
  bus.motors[1].silent = true;
  std::vector<CanBus*> buses{&bus};
  volatile std::sig_atomic_t stop = 0;
  std::vector<std::string> told;
  discover_drives(robot, buses, false, 3.5, stop,
                  [&](const std::string& missing) { told.push_back(missing); });
  EXPECT_EQ(told, std::vector<std::string>({"joint2 (id 0x2 on virtual:test)"}));
}

TEST(DriveDiscoveryTest, AMotorThatAnswersWithIdentifier0IsNamed) {
  Robot robot = testing::test_robot(3);
  robot.buses[0].can = "virtual:test";
  PromptBus bus(robot, 0);
  bus.motors[1] = testing::FakeMotor([&] {
    DriveConfig drive = robot.joints[1].drive;
    drive.reply_id = 0;
    return drive;
  }());
  std::vector<CanBus*> buses{&bus};
  volatile std::sig_atomic_t stop = 0;
  EXPECT_EQ(discover_drives(robot, buses, false, 0.15, stop),
            "joint2 (id 0x2 on virtual:test); joint2 answers with id 0x0 instead of 0x12 (Damiao: "
            "MST_ID, register 7)");
}

TEST(DriveDiscoveryTest, TwoMotorsWithOneIdAreNamed) {
  Robot robot = testing::test_robot(3);
  robot.buses[0].can = "virtual:test";
  PromptBus bus(robot, 0);
  std::vector<CanBus*> buses{&bus};
  EXPECT_EQ(find_twins(robot, buses), "");
  bus.motors.emplace_back(robot.joints[1].drive);
  EXPECT_EQ(find_twins(robot, buses), "joint2 (id 0x2 on virtual:test)");
}

TEST(DriveDiscoveryTest, RoundTripsOfABusThatAnswersAtOnceAreShort) {
  const Robot robot = testing::test_robot(3);
  PromptBus bus(robot, 0);
  std::vector<CanBus*> buses{&bus};
  const std::vector<RoundTrip> trips = measure_round_trips(robot, buses);
  ASSERT_EQ(trips.size(), 1U);
  EXPECT_EQ(trips[0].answered, kRoundTrips);
  EXPECT_LE(trips[0].least_ns, trips[0].longest_ns);
  bus.motors[0].silent = true;
  EXPECT_EQ(measure_round_trips(robot, buses)[0].answered, 0);
}

}  // namespace
}  // namespace limber::test_drive_discovery
