// Counts, gaps and load of frames whose times and lengths are known.
#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "drivers/can/frame_time.h"
#include "tests/tools/can/arms.h"
#include "tools/can/statistics.h"

namespace limber::test_statistics {
namespace {

using bus_tools::BusStatistics;
using testing::candump_frame;

constexpr std::int64_t kMs = 1'000'000;

bool contains_line(const std::string& text, const std::string& pattern) {
  return std::regex_search(text, std::regex(pattern));
}

TEST(Statistics, RateMeanAndGreatestGap) {
  const Robot robot = testing::one_motor("damiao_mit", 0x003, 0x013);
  BusStatistics statistics(robot);
  for (const std::int64_t at_ms : {0, 1, 2, 5, 6})
    statistics.add(at_ms * kMs, 0, candump_frame("003#"));
  // Four gaps in 6 ms.
  EXPECT_TRUE(
      contains_line(statistics.text(), " 003  elbow +command +5 +666\\.7 +1\\.500 +3\\.000 "))
      << statistics.text();
}

// An empty frame with identifier 003 is sent in 49 bits and its stuff bits; ten in 1 ms.
TEST(Statistics, LoadIsTheTimeOnTheWire) {
  const Robot robot = testing::one_motor("damiao_mit", 0x003, 0x013);
  BusStatistics statistics(robot);
  const CanFrame frame = candump_frame("003#");
  for (int i = 0; i <= 10; ++i) statistics.add(i * kMs / 10, 0, frame);
  const int bits = classic_frame_bits(frame);
  const double percent = 100.0 * 11 * bits * 1e-6 / 1e-3;
  EXPECT_TRUE(contains_line(statistics.text(), fmt::format("load {:.1f} % of 1 Mbit/s", percent)))
      << statistics.text();
  // One FD command and reply of 8 bytes each a millisecond, at most 56.6 us each (docs), and every
  // 20 cycles such a pair for a setting: 1.05 * 113.2 us.
  EXPECT_TRUE(contains_line(statistics.text(), "predicted at 1000 Hz: .*at most 11\\.9 %"))
      << statistics.text();
}

TEST(Statistics, ErrorFramesAndLockStepAreNoLoad) {
  const Robot robot = testing::one_motor("damiao_mit", 0x003, 0x013);
  BusStatistics statistics(robot);
  statistics.add(0, 0, candump_frame("003#"));
  statistics.add(1 * kMs, 0, candump_frame("1FFFFFF0#0A00000000000000"));
  statistics.add(2 * kMs, 0, candump_frame("1FFFFFF1#0A00000000000000"));
  statistics.add(3 * kMs, 0, candump_frame("20000040#0000000000000000"));
  const std::string text = statistics.text();
  EXPECT_TRUE(contains_line(text, "\n  1 error frames")) << text;
  EXPECT_TRUE(contains_line(text, "\n  2 frames TICK and TOCK")) << text;
  EXPECT_FALSE(contains_line(text, "1FFFFFF")) << text;
}

TEST(Statistics, AnIdentifierThatSeveralJointsShareSaysSo) {
  Robot robot = testing::one_motor("damiao_mit", 0x003, 0x013);
  robot.joints.push_back(robot.joints.front());
  robot.joints[1].name = "wrist";
  robot.joints[1].drive.command_id = 0x004;
  robot.joints[1].drive.reply_id = 0x014;
  BusStatistics statistics(robot);
  statistics.add(0, 0, candump_frame("7FF#0300CC0000000000"));
  statistics.add(0, 0, candump_frame("7FF#0400CC0000000000"));
  EXPECT_TRUE(contains_line(statistics.text(), " 7FF  several +command +2 ")) << statistics.text();
}

}  // namespace
}  // namespace limber::test_statistics
