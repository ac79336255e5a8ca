// Counting cycles that took longer than their period.
#include <gtest/gtest.h>

#include "drivers/processes/overrun_watch.h"

namespace limber::test_overrun_watch {
namespace {

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
}  // namespace limber::test_overrun_watch
