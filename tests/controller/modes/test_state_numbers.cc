// The numbers of JOINT_STATEs: repeated, missed, too high to be believed, forgotten.
#include <gtest/gtest.h>

#include <limits>

#include "controller/modes/state_judge.h"

namespace limber::controller::test_state_numbers {
namespace {

constexpr std::int64_t kHighest = std::numeric_limits<std::int64_t>::max();

class StateNumbers : public ::testing::Test {
 protected:
  StateJudgement judge(std::int64_t seq) {
    joint_state_t state{};
    state.seq = seq;
    state.session = session_;
    state.period_ns = 1'000'000;
    state.num_joints = 1;
    state.joint_flags[0] = joint_state_t::JOINT_FRESH;
    return judge_.judge(state);
  }
  /// A state that is not believed changes nothing.
  void expect_doubted(std::int64_t seq) {
    const std::int64_t received = judge_.received();
    const std::int64_t lost = judge_.lost();
    const StateJudgement judgement = judge(seq);
    EXPECT_FALSE(judgement.usable || judgement.fresh || judgement.repeated) << seq;
    EXPECT_EQ(judgement.missed, 0) << seq;
    EXPECT_EQ(judge_.received(), received) << seq;
    EXPECT_EQ(judge_.lost(), lost) << seq;
  }

  StateJudge judge_{1, 2};
  std::int64_t session_ = 5;
};

TEST_F(StateNumbers, TheFirstMayHaveAny) {
  for (const std::int64_t seq : {std::int64_t{0}, std::int64_t{123'456}, kHighest}) {
    judge_ = StateJudge(1, 2);
    const StateJudgement first = judge(seq);
    EXPECT_TRUE(first.first && first.fresh && !first.silent) << seq;
    EXPECT_EQ(first.missed, 0);
    EXPECT_TRUE(judge(seq).repeated);
    EXPECT_EQ(judge_.lost(), 0);
  }
}

TEST_F(StateNumbers, AThousandHigherIsBelieved) {
  judge(10);
  const StateJudgement after = judge(1010);
  EXPECT_TRUE(after.usable && after.silent);
  EXPECT_EQ(after.missed, 999);
  EXPECT_EQ(judge_.lost(), 999);
  judge(1013);
  EXPECT_EQ(judge_.lost(), 1001) << "they add up";
}

TEST_F(StateNumbers, AHigherOneAloneIsNot) {
  judge(10);
  expect_doubted(1011);
  EXPECT_TRUE(judge(11).fresh) << "the true ones go on";
  expect_doubted(kHighest);
  EXPECT_TRUE(judge(12).fresh);
}

TEST_F(StateNumbers, TheNextOneConfirmsIt) {
  for (const std::int64_t next : {5001, 6000}) {
    judge_ = StateJudge(1, 2);
    judge(10);
    expect_doubted(5000);
    const StateJudgement confirmed = judge(next);
    EXPECT_TRUE(confirmed.fresh && confirmed.silent) << next;
    EXPECT_FALSE(confirmed.first || confirmed.new_session);
    EXPECT_EQ(confirmed.missed, 1000) << "at least so many";
    EXPECT_EQ(judge_.lost(), 1000);
    EXPECT_EQ(judge(next + 1).missed, 0) << "the stream goes on from there";
  }
}

TEST_F(StateNumbers, WhatDoesNotGoOnFromItIsDoubtedInItsPlace) {
  judge(10);
  expect_doubted(5000);
  expect_doubted(5000);
  expect_doubted(6001);
  expect_doubted(4000);
  EXPECT_TRUE(judge(4001).usable);
}

TEST_F(StateNumbers, ATrueOneEndsTheDoubt) {
  judge(10);
  expect_doubted(5000);
  judge(11);
  expect_doubted(5001);
  EXPECT_TRUE(judge(5002).usable);
  expect_doubted(9000);
  ++session_;
  expect_doubted(0);
  EXPECT_TRUE(judge(1).new_session);
  expect_doubted(9001);
}

TEST_F(StateNumbers, AnotherSessionMayBeginAnywhere) {
  judge(10);
  for (const std::int64_t seq : {std::int64_t{3}, std::int64_t{90'000}, kHighest}) {
    ++session_;
    expect_doubted(seq);
    const StateJudgement judgement = judge(seq);  // as lock step repeats it
    EXPECT_TRUE(judgement.new_session && judgement.fresh && !judgement.silent) << seq;
    EXPECT_FALSE(judgement.first);
    EXPECT_EQ(judgement.missed, 0);
  }
}

TEST_F(StateNumbers, ASingleOneOfAnotherSessionIsPassedOver) {
  judge(10);
  for (const std::int64_t other : {6, 7, 6}) {
    session_ = other;
    expect_doubted(3);
    session_ = 5;
    const StateJudgement after = judge(judge_.received() + 10);
    EXPECT_TRUE(after.usable && !after.new_session) << other;
    EXPECT_EQ(after.missed, 0) << other;
  }
  EXPECT_EQ(judge_.doubted(), 3);
  session_ = 6;
  expect_doubted(40);
  session_ = 7;
  expect_doubted(41);
  EXPECT_TRUE(judge(42).new_session) << "two of one session";
  EXPECT_EQ(judge_.doubted(), 4) << "41 was no stray";
}

TEST_F(StateNumbers, AnotherSessionIsBelievedIfItGoesOn) {
  const auto after_one_at = [&](std::int64_t seq, std::int64_t next) {
    judge_ = StateJudge(1, 2);
    session_ = 5;
    judge(10);
    session_ = 6;
    EXPECT_TRUE(judge(seq).doubted);
    return judge(next).new_session;
  };
  EXPECT_TRUE(after_one_at(0, 1));
  EXPECT_TRUE(after_one_at(50, 50));
  EXPECT_FALSE(after_one_at(50, 49));
  EXPECT_TRUE(after_one_at(50, 1050));
  EXPECT_FALSE(after_one_at(50, 1051));
}

TEST_F(StateNumbers, ATrueOneInBetweenEndsTheOtherSession) {
  judge(10);
  session_ = 6;
  expect_doubted(40);
  session_ = 5;
  EXPECT_TRUE(judge(11).usable);
  session_ = 6;
  expect_doubted(41);
}

TEST_F(StateNumbers, WhatIsIgnored) {
  EXPECT_FALSE(judge(10).ignored());
  StateJudgement judgement = judge(10);
  EXPECT_TRUE(judgement.repeated && !judgement.doubted && judgement.ignored());
  session_ = 6;
  judgement = judge(11);
  EXPECT_TRUE(judgement.doubted && !judgement.repeated && judgement.ignored());
  session_ = 0;
  judgement = judge(12);
  EXPECT_FALSE(judgement.doubted || judgement.usable || judgement.ignored());
}

TEST_F(StateNumbers, AfterALongSilenceTheSessionGoesOnAnywhere) {
  judge(500);
  for (const std::int64_t seq : {std::int64_t{3}, std::int64_t{0}, kHighest}) {
    judge_.forget_sequence();
    const StateJudgement judgement = judge(seq);
    EXPECT_TRUE(judgement.fresh && !judgement.repeated) << seq;
    EXPECT_FALSE(judgement.first || judgement.new_session);
    EXPECT_EQ(judgement.missed, 0);
    EXPECT_TRUE(judge(seq).repeated) << "only once";
  }
  EXPECT_EQ(judge_.lost(), 0);
}

}  // namespace
}  // namespace limber::controller::test_state_numbers
