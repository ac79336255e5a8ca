// Whose requests are obeyed: the lease, its renewal and its end.
#include "tests/controller/modes/supervisor_bench.h"

namespace limber::controller::test_lease {
namespace {

using namespace supervisor_bench;

constexpr std::int64_t kLeaseCycles = Supervisor::kLease_ns / kPeriod_ns;

class Lease : public SupervisorBench {
 protected:
  bool other_may() const { return supervisor_.check_client(kOther) == nullptr; }
  void one_ns_later(std::int8_t drive_state) {
    late_ns_ = 1 - kPeriod_ns;
    states(1, drive_state);
    late_ns_ = 0;
  }
};

TEST_F(Lease, EndsTenSecondsAfterTheLastRequest) {
  states(100, State::DRIVE_OFF);
  ASSERT_EQ(ask(Request::REQUEST_IDLE), "");
  states(5000, State::DRIVE_OFF);
  ASSERT_EQ(ask(Request::REQUEST_IDLE), "");
  states(kLeaseCycles, State::DRIVE_OFF);
  EXPECT_FALSE(other_may()) << "10 s after the second";
  one_ns_later(State::DRIVE_OFF);
  EXPECT_TRUE(other_may());
  EXPECT_EQ(supervisor_.check_client(kMine), nullptr);
  ASSERT_EQ(ask(Request::REQUEST_IDLE, kOther), "");
  EXPECT_TRUE(other_may());
  EXPECT_NE(supervisor_.check_client(kMine), nullptr) << "it is the other's now";
}

TEST_F(Lease, GoalsAndGainsRenewIt) {
  states(100, State::DRIVE_OFF);
  supervisor_.take_lease(kMine);
  states(kLeaseCycles - 1, State::DRIVE_OFF);
  supervisor_.take_lease(kMine);
  states(kLeaseCycles, State::DRIVE_OFF);
  EXPECT_FALSE(other_may());
}

TEST_F(Lease, LastsAsLongAsTheArmMovesForItsHolder) {
  to_hold();
  ASSERT_EQ(ask(Request::REQUEST_ACTIVE), "");
  states(kLeaseCycles + 1, State::DRIVE_ON);
  EXPECT_FALSE(other_may()) << "ACTIVE";
  ASSERT_EQ(ask(Request::REQUEST_STOP, kOther), "");
  EXPECT_FALSE(other_may()) << "SOFT_STOP";
  states(kSoftStop_ns / kPeriod_ns, State::DRIVE_ON);
  ASSERT_EQ(supervisor_.mode(), Mode::kHold);
  EXPECT_TRUE(other_may());
}

}  // namespace
}  // namespace limber::controller::test_lease
