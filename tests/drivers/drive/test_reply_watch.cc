// The watchdog on replies: what is bridged, what is too much, and the memory of losses behind it.
#include <gtest/gtest.h>

#include "drivers/drive/reply_watch.h"

namespace limber::test_reply_watch {
namespace {

constexpr int kCyclesPerSecond = 1000;

/// Two cycles are bridged, as on a wire.
struct Bench {
  void cycles(int count, bool answered) {
    for (int i = 0; i < count; ++i) watch.close_cycle(answered, cycle++);
  }
  ReplyWatch watch{kCyclesPerSecond, 2};
  std::int64_t cycle = 0;
};

TEST(ReplyWatchTest, TwoInARowAreBridgedAThirdIsNot) {
  Bench bench;
  EXPECT_EQ(bench.watch.missing(), 0);
  EXPECT_FALSE(bench.watch.lost());
  bench.cycles(2, false);
  EXPECT_EQ(bench.watch.missing(), 2);
  EXPECT_FALSE(bench.watch.lost());
  bench.cycles(1, true);
  EXPECT_EQ(bench.watch.missing(), 0);
  bench.cycles(3, false);
  EXPECT_EQ(bench.watch.missing(), 3);
  EXPECT_TRUE(bench.watch.lost());
}

// 5 b = 10 losses, two in each pair, pairs `apart` cycles apart: the tenth comes 4 apart + 1 later.
TEST(ReplyWatchTest, TenWithinASecondAreTooMany) {
  for (int apart : {249, 250}) {
    Bench bench;
    for (int pair = 0; pair < 5; ++pair) {
      EXPECT_FALSE(bench.watch.lost()) << pair;
      bench.cycles(2, false);
      if (pair < 4) bench.cycles(apart - 2, true);
    }
    EXPECT_EQ(bench.watch.lost(), 4 * apart + 1 < kCyclesPerSecond) << apart;
  }
}

TEST(ReplyWatchTest, AnAnswerIsNoLossHoweverManyThereWere) {
  Bench bench;
  for (int i = 0; i < 9; ++i) {
    bench.cycles(1, false);
    bench.cycles(1, true);
  }
  bench.cycles(5, true);
  EXPECT_FALSE(bench.watch.lost());
  bench.cycles(1, false);
  EXPECT_TRUE(bench.watch.lost());
}

TEST(ReplyWatchTest, LateIsNotLost) {
  Bench bench;
  for (int i = 0; i < 20; ++i) {
    bench.cycles(1, false);
    bench.watch.came_late();
    EXPECT_EQ(bench.watch.missing(), 0);
  }
  EXPECT_FALSE(bench.watch.lost());
}

// Nothing is missing: an old reply undoes no loss that was counted before.
TEST(ReplyWatchTest, ALateReplyToAnAnsweredCycleChangesNothing) {
  Bench bench;
  for (int i = 0; i < 10; ++i) {
    EXPECT_FALSE(bench.watch.lost()) << i;
    bench.cycles(1, false);
    bench.cycles(1, true);
    bench.watch.came_late();
  }
  EXPECT_TRUE(bench.watch.lost());
}

TEST(ReplyWatchTest, TrustedUntilLostAndAfterFiftyMillisecondsWithoutAGap) {
  Bench bench;
  bench.cycles(2, false);
  EXPECT_TRUE(bench.watch.trusted());
  bench.cycles(1, false);
  EXPECT_FALSE(bench.watch.trusted());
  bench.cycles(49, true);
  EXPECT_FALSE(bench.watch.trusted());
  bench.cycles(1, false);
  bench.cycles(49, true);
  EXPECT_FALSE(bench.watch.trusted()) << "a gap begins it anew";
  bench.cycles(1, true);
  EXPECT_TRUE(bench.watch.trusted());
  EXPECT_TRUE(bench.watch.lost()) << "until it is reset";
}

TEST(ReplyWatchTest, ResetForgetsAll) {
  Bench bench;
  bench.cycles(3, false);
  bench.watch.reset();
  EXPECT_FALSE(bench.watch.lost());
  EXPECT_EQ(bench.watch.missing(), 0);
  for (int i = 0; i < 9; ++i) {
    bench.cycles(1, false);
    bench.cycles(1, true);
    EXPECT_FALSE(bench.watch.lost()) << "nine, counted from the reset";
  }
}

TEST(LossWindowTest, FiveForEachBridgedCycleAndFiveAtLeast) {
  for (int bridged : {-1, 0, 1, 3}) {
    LossWindow window(bridged);
    const int most = bridged == 3 ? 15 : 5;
    for (int loss = 1; loss <= most; ++loss) EXPECT_EQ(window.add(7, 1), loss == most) << bridged;
  }
}

TEST(LossWindowTest, TheOldestWithinTheSpanCounts) {
  LossWindow window(1);
  for (std::int64_t cycle : {0, 10, 20, 30}) EXPECT_FALSE(window.add(cycle, 40));
  EXPECT_FALSE(window.add(40, 40)) << "0 to 40: 41 cycles";
  EXPECT_TRUE(window.add(49, 40)) << "10 to 49: 40 cycles";
}

TEST(LossWindowTest, WhatIsUndoneWasNeverThere) {
  LossWindow window(1);
  window.undo();
  for (int loss = 0; loss < 4; ++loss) EXPECT_FALSE(window.add(100 * loss, 401));
  for (int again = 0; again < 12; ++again) {  // around the ring
    EXPECT_TRUE(window.add(400, 401)) << again;
    window.undo();
  }
  EXPECT_FALSE(window.add(401, 401)) << "0 to 401: 402 cycles";
  window.clear();
  for (int loss = 0; loss < 4; ++loss) EXPECT_FALSE(window.add(500, 401));
  EXPECT_TRUE(window.add(500, 401));
}

}  // namespace
}  // namespace limber::test_reply_watch
