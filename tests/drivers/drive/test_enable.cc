// The dialogue that enables one drive, step by step, and what turns it back.
#include <gtest/gtest.h>

#include <cmath>

#include "drivers/drive/enable.h"
#include "tests/drivers/drive/damiao_reply.h"

namespace limber::test_enable {
namespace {

using testing::answer;
using testing::kDisabled;
using testing::kEnabled;
using testing::kOverCurrent;

class EnableTest : public ::testing::Test {
 protected:
  EnableTest() : link(testing::test_robot(1).joints[0], true, 1e-3, 2) { reply(kDisabled); }

  void reply(int state) { answer(&link, {state, 0.0, 0.0, 0.0}); }
  /// A cycle: what is sent, then the motor's state before it.
  char cycle(int state) {
    const char sent = next();
    reply(state);
    dialogue.close_cycle(link);
    return sent;
  }
  /// Clear, enable, or zero torque.
  char next() {
    const CanFrame frame = dialogue.next_frame(&link);
    if (same(frame, link.clear_error())) return 'c';
    if (same(frame, link.enable())) return 'e';
    const testing::RawCommand raw = testing::raw_command(frame);
    const bool zero = raw.kp == 0 && raw.kd == 0 && std::abs(raw.t - 2047.5) < 1.0;
    return zero && !testing::is_special(frame) ? 'z' : '?';
  }
  static bool same(const CanFrame& a, const CanFrame& b) {
    return a.id == b.id && a.length == b.length && a.data == b.data;
  }

  JointLink link;
  EnableDialogue dialogue;
};

TEST_F(EnableTest, ZeroEnableConfirm) {
  EXPECT_EQ(next(), 'z') << "before its start";
  dialogue.start(link);
  EXPECT_EQ(cycle(kDisabled), 'z');
  EXPECT_EQ(cycle(kDisabled), 'e');
  EXPECT_FALSE(dialogue.done(link));
  EXPECT_EQ(cycle(kEnabled), 'z');
  EXPECT_TRUE(dialogue.done(link));
  link.begin_cycle();
  EXPECT_FALSE(dialogue.done(link)) << "no answer in this cycle";
}

TEST_F(EnableTest, AnErrorIsClearedFirst) {
  reply(kOverCurrent);
  dialogue.start(link);
  EXPECT_EQ(cycle(kOverCurrent), 'c');
  EXPECT_EQ(cycle(kDisabled), 'z');
  EXPECT_EQ(cycle(kDisabled), 'e');
}

TEST_F(EnableTest, AnErrorThatIsStillThereIsClearedAgain) {
  reply(kOverCurrent);
  dialogue.start(link);
  EXPECT_EQ(cycle(kOverCurrent), 'c');
  EXPECT_EQ(cycle(kOverCurrent), 'z');
  EXPECT_EQ(cycle(kOverCurrent), 'c');
}

TEST_F(EnableTest, ADriveThatIsNotEnabledIsToldAgain) {
  dialogue.start(link);
  cycle(kDisabled);
  cycle(kDisabled);
  EXPECT_EQ(cycle(kDisabled), 'z');
  EXPECT_FALSE(dialogue.done(link));
  EXPECT_EQ(cycle(kDisabled), 'e');
  EXPECT_EQ(cycle(kOverCurrent), 'z');
  EXPECT_EQ(cycle(kDisabled), 'c');
}

TEST_F(EnableTest, AStepWithoutAnAnswerIsRepeated) {
  dialogue.start(link);
  for (const char step : {'z', 'e'}) {
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(next(), step);
      link.begin_cycle();
      dialogue.close_cycle(link);
    }
    EXPECT_EQ(cycle(kDisabled), step);
  }
}

// It was enabled before anybody asked: the dialogue still goes through all its steps.
TEST_F(EnableTest, DoneIsAfterTheLastStepOnly) {
  reply(kEnabled);
  dialogue.start(link);
  EXPECT_FALSE(dialogue.done(link));
  cycle(kEnabled);
  EXPECT_FALSE(dialogue.done(link));
  cycle(kEnabled);
  EXPECT_TRUE(dialogue.done(link));
}

TEST_F(EnableTest, OnlyATorqueCommandCountsAsApplied) {
  reply(kEnabled);
  const double count_Nm = 20.0 / 4095.0;
  const auto applied_after = [this](auto send) {
    link.torque(2.0);
    send();
    return link.tau_applied();
  };
  EXPECT_NEAR(applied_after([] {}), 2.0, count_Nm);
  EXPECT_EQ(applied_after([this] { link.disable(); }), 0.0);
  EXPECT_EQ(applied_after([this] { link.clear_error(); }), 0.0);
  EXPECT_EQ(applied_after([this] { link.enable(); }), 0.0);
  EXPECT_EQ(applied_after([this] { link.state_request(); }), 0.0);
}

TEST(JointLinkStart, BeforeTheFirstReplyAJointIsAtItsZero) {
  const JointLink link(testing::test_robot(2).joints[1], true, 1e-3, 2);
  EXPECT_EQ(link.theta(), 0.0);
  EXPECT_DOUBLE_EQ(link.angle_resolution(), 25.0 / 65535.0);
}

}  // namespace
}  // namespace limber::test_enable
