// Who is on a bus of CANopen drives: their servers may be slow, and say nothing of the cycle.
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>

#include "drivers/drive/drive_discovery.h"
#include "tests/drivers/families/fake_cia402.h"

namespace limber::test_cia402_discovery {
namespace {

using testing::cia402_robot;
using testing::FakeCia402;

const std::string kAsked = "603#4000100000000000";  // device type

/// Node 3, whose answers are there at once; with `chatty`, a TPDO and a heartbeat behind each.
class ServerBus final : public CanBus {
 public:
  explicit ServerBus(int nodes, bool chatty = false) : chatty_(chatty) {
    for (int i = 0; i < nodes; ++i) drives.emplace_back(robot.joints[0], false);
  }
  int send(std::span<const CanFrame> frames) noexcept override {
    for (const CanFrame& frame : frames) {
      for (FakeCia402& drive : drives) {
        for (const CanFrame& answer : drive.handle(frame)) replies_.push_back(answer);
        for (const std::uint32_t id : {0x183U, 0x703U}) {
          CanFrame other;
          other.id = id;
          other.length = 1;
          if (chatty_) replies_.push_back(other);
        }
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

  Robot robot = one_joint();
  std::vector<FakeCia402> drives;
  std::vector<CanBus*> buses{this};

 private:
  static Robot one_joint() {
    Robot robot = cia402_robot(false);
    robot.joints.resize(1);
    return robot;
  }
  bool chatty_;
  std::deque<CanFrame> replies_;
  CanStatistics statistics_;
};

TEST(Cia402Discovery, TwoNodesWithOneNumberAreNamed) {
  ServerBus single(1);
  EXPECT_EQ(find_twins(single.robot, single.buses), "");
  ServerBus chatty(1, true);
  EXPECT_EQ(find_twins(chatty.robot, chatty.buses), "");
  ServerBus twins(2);
  EXPECT_NE(find_twins(twins.robot, twins.buses).find("joint1 (node 3"), std::string::npos);
}

TEST(Cia402Discovery, ServersAreNotTimed) {
  ServerBus bus(1);
  EXPECT_EQ(measure_round_trips(bus.robot, bus.buses)[0].answered, 0);
  EXPECT_TRUE(bus.drives[0].heard.empty());
}

TEST(Cia402Discovery, ASlowServerIsAskedOnceASecond) {
  ServerBus bus(1);
  bus.drives[0].silent = true;
  volatile std::sig_atomic_t stop = 0;
  EXPECT_NE(discover_drives(bus.robot, bus.buses, false, 0.5, stop), "");
  EXPECT_EQ(bus.drives[0].heard, std::vector<std::string>{kAsked});
}

}  // namespace
}  // namespace limber::test_cia402_discovery
