#include <gtest/gtest.h>

#include "common/pacer.h"

namespace limber::test_pacer {
namespace {

constexpr std::int64_t kPeriod_ns = 1'000'000;

/// A loop on a clock that the test sets: it sleeps until it is due, then works.
struct Loop {
  Pacer pacer{kPeriod_ns};
  std::int64_t now_ns = 5'000'000'000;
  std::optional<double> behind;

  /// When the cycle began.
  std::int64_t cycle(std::int64_t work_ns) {
    now_ns = std::max(now_ns, pacer.next_due_ns(now_ns));
    if (const auto found = pacer.behind(now_ns)) behind = found;
    const std::int64_t begun_ns = now_ns;
    now_ns += work_ns;
    return begun_ns;
  }
};

TEST(Pacer, ACycleBeginsAPeriodAfterTheOneBefore) {
  Loop loop;
  const std::int64_t first_ns = loop.cycle(100'000);
  EXPECT_EQ(first_ns, 5'000'000'000);
  for (int k = 1; k < 5000; ++k) ASSERT_EQ(loop.cycle(300'000), first_ns + k * kPeriod_ns);
  EXPECT_NEAR(loop.pacer.share(loop.now_ns), 1.0, 1e-3);
  EXPECT_FALSE(loop.behind);
}

TEST(Pacer, AShortPauseIsMadeUpFor) {
  Loop loop;
  const std::int64_t first_ns = loop.cycle(0);
  loop.cycle(Pacer::kMostCatchUp_ns);  // nearly as long behind
  for (int k = 2; k < 100; ++k) loop.cycle(100'000);
  EXPECT_EQ(loop.cycle(0), first_ns + 100 * kPeriod_ns) << "on the old schedule again";
}

TEST(Pacer, AfterALongPauseTheScheduleBeginsAnewAndNothingSprints) {
  Loop loop;
  loop.cycle(0);
  loop.cycle(700'000'000);
  const std::int64_t after_ns = loop.now_ns;
  for (int k = 0; k < 50; ++k)
    ASSERT_EQ(loop.cycle(100'000), after_ns + k * kPeriod_ns) << "cycle " << k;
}

TEST(Pacer, CatchingUpIsBounded) {
  for (const std::int64_t pause_ns : {5'000'000LL, 49'000'000LL, 55'000'000LL, 3'000'000'000LL}) {
    Loop loop;
    loop.cycle(0);
    loop.cycle(pause_ns);
    int soon = 0;
    for (std::int64_t last_ns = loop.cycle(0), k = 0; k < 100; ++k) {
      const std::int64_t begun_ns = loop.cycle(0);
      if (begun_ns - last_ns < kPeriod_ns) ++soon;
      last_ns = begun_ns;
    }
    EXPECT_LE(soon, Pacer::kMostCatchUp_ns / kPeriod_ns) << pause_ns;
  }
}

TEST(Pacer, TellsThatItIsBehindAndByHowMuch) {
  Loop loop;
  for (int k = 0; k < 1500; ++k) loop.cycle(3'000'000);
  ASSERT_TRUE(loop.behind);
  EXPECT_NEAR(*loop.behind, 1.0 / 3.0, 0.01);
  EXPECT_NEAR(loop.pacer.share(loop.now_ns), 1.0 / 3.0, 0.01);
}

TEST(Pacer, ASingleStallOfTheHostIsNotBehind) {
  Loop loop;
  for (int k = 0; k < 10'000; ++k) loop.cycle(k % 3000 == 10 ? 150'000'000 : 200'000);
  EXPECT_FALSE(loop.behind);
}

TEST(Pacer, OneWindowIsToldOnce) {
  Loop loop;
  int told = 0;
  const std::int64_t begin_ns = loop.now_ns;
  while (loop.now_ns < begin_ns + 4 * Pacer::kWindow_ns) {
    loop.behind.reset();
    loop.cycle(2'000'000);
    told += loop.behind ? 1 : 0;
  }
  EXPECT_EQ(told, 3);
}

}  // namespace
}  // namespace limber::test_pacer
