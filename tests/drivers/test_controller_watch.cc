// The watchdog on the controller's answers, and what it counts.
#include <gtest/gtest.h>

#include <type_traits>
#include <utility>

#include "drivers/arm_drives.h"
#include "drivers/controller_watch.h"

namespace limber::test_controller_watch {
namespace {

constexpr int kAccepted = driver_status_t::VERDICT_ACCEPTED;
constexpr int kRate = driver_status_t::VERDICT_RATE;

TEST(ControllerWatchTest, AsManyCyclesAsBridgedAndNotOneMore) {
  ControllerWatch watch(2);
  watch.note(kAccepted);
  watch.next_cycle(true);
  for (int silent = 1; silent <= 3; ++silent) {
    EXPECT_FALSE(watch.lost()) << silent;
    watch.next_cycle(true);
  }
  EXPECT_TRUE(watch.lost());
  watch.note(kRate);  // a refused command is no answer
  watch.next_cycle(true);
  EXPECT_TRUE(watch.lost());
  watch.note(kAccepted);
  watch.next_cycle(true);
  EXPECT_FALSE(watch.lost());
}

// Whoever has not begun is silent from the first cycle on.
TEST(ControllerWatchTest, CountsFromItsStart) {
  ControllerWatch watch(2);
  for (int silent = 1; silent <= 3; ++silent) {
    EXPECT_FALSE(watch.lost()) << silent;
    watch.next_cycle(false);
  }
  EXPECT_TRUE(watch.lost());
}

TEST(ControllerWatchTest, CountsVerdictsAndAnswersMissedByTheLeaseHolder) {
  ControllerWatch watch(2);
  watch.next_cycle(false);  // nobody has the arm: nothing is missing
  for (int verdict : {kAccepted, kRate, kAccepted, kRate, kRate}) {
    watch.note(verdict);
    watch.next_cycle(true);
  }
  watch.next_cycle(true);
  driver_status_t status{};
  watch.write_status(&status);
  EXPECT_EQ(status.commands_accepted, 2);
  EXPECT_EQ(status.commands_refused[kRate], 3);
  EXPECT_EQ(status.commands_refused[kAccepted], 0);
  EXPECT_EQ(status.commands_missing, 4);  // three refused, one silent
}

// 2^31 cycles at 20 kHz are 30 hours.
static_assert(std::is_same_v<decltype(std::declval<ArmDrives&>().cycles_in_state()), std::int64_t>);
static_assert(std::is_same_v<decltype(driver_status_t::commands_missing), std::int64_t>);
static_assert(sizeof(driver_status_t::replies_lost) / 16 == sizeof(std::int64_t));

}  // namespace
}  // namespace limber::test_controller_watch
