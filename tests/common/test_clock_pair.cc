// Two clocks read together while the machine stands still now and then, by clocks of the test's
// own.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "common/clock_pair.h"

namespace limber::test_clock_pair {
namespace {

constexpr std::int64_t kAhead_ns = 1'700'000'000'000'000'000;
constexpr std::int64_t kPause_ns = 4'000'000;

/// Each reading of a clock takes `kReading_ns`, and a pause behind the one that `pauses` names.
class Machine {
 public:
  static constexpr std::int64_t kReading_ns = 50;

  explicit Machine(std::vector<std::int64_t> pauses) : pauses_(std::move(pauses)) {}

  ClockPair pair() {
    return read_together([this] { return read(); }, [this] { return read() + kAhead_ns; });
  }
  /// How much later than the other clock the monotonic one was read.
  std::int64_t error_ns() {
    const ClockPair found = pair();
    return found.monotonic_ns - (found.other_ns - kAhead_ns);
  }
  std::size_t readings() const { return readings_; }

 private:
  std::int64_t read() {
    now_ns_ += kReading_ns;
    const std::int64_t read_ns = now_ns_;
    if (readings_ < pauses_.size()) now_ns_ += pauses_[readings_];
    ++readings_;
    return read_ns;
  }

  std::vector<std::int64_t> pauses_;
  std::size_t readings_ = 0;
  std::int64_t now_ns_ = 1'000'000;
};

TEST(ClockPair, WithoutAPauseEachIsReadOnceAndOneOnceMore) {
  Machine machine({});
  EXPECT_EQ(machine.error_ns(), Machine::kReading_ns);
  EXPECT_EQ(machine.readings(), 3U);
}

// Stamped by the wall clock, a reply would seem to have come before its command.
TEST(ClockPair, APauseBetweenTheTwoDoesNotCount) {
  for (const std::vector<std::int64_t>& pauses :
       {std::vector<std::int64_t>{kPause_ns}, {0, kPause_ns}, {kPause_ns, kPause_ns}}) {
    Machine machine(pauses);
    EXPECT_EQ(machine.error_ns(), Machine::kReading_ns);
    EXPECT_EQ(machine.readings(), 6U);
  }
}

TEST(ClockPair, APauseBehindBothIsNone) {
  Machine machine({0, 0, kPause_ns});
  EXPECT_EQ(machine.error_ns(), Machine::kReading_ns);
  EXPECT_EQ(machine.readings(), 3U);
}

TEST(ClockPair, OfPausesEachTimeTheShortestCountsAndNothingSeemsEarlier) {
  Machine machine({kPause_ns, kPause_ns, 0, 0, kPause_ns / 4, 0, kPause_ns, 0, 0, kPause_ns});
  EXPECT_EQ(machine.error_ns(), Machine::kReading_ns + kPause_ns / 4);
  EXPECT_EQ(machine.readings(), 12U);
  Machine always(std::vector<std::int64_t>(12, kPause_ns));
  EXPECT_GE(always.error_ns(), 0);
}

}  // namespace
}  // namespace limber::test_clock_pair
