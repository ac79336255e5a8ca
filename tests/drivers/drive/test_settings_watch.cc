// Settings that are read again: which, when they count as changed, and what says nothing.
#include <gtest/gtest.h>

#include "drivers/drive/settings_watch.h"

namespace limber::test_settings_watch {
namespace {

/// Step i asks with identifier i for what is i; an answer is its identifier and its value.
class FakeStartup final : public StartupDialogue {
 public:
  explicit FakeStartup(std::vector<bool> readable) : readable_(std::move(readable)) {}

  CanFrame presence_request() const noexcept override { return {}; }
  bool is_presence(const CanFrame& /*frame*/) const noexcept override { return true; }
  int steps() const noexcept override { return static_cast<int>(readable_.size()); }
  StartupStep step(int index) const noexcept override {
    return {100U + static_cast<std::uint32_t>(index), static_cast<double>(index)};
  }
  CanFrame request(int index) const noexcept override {
    CanFrame frame;
    frame.id = static_cast<std::uint32_t>(index);
    return frame;
  }
  bool can_be_polled(int index) const noexcept override {
    return readable_.at(static_cast<std::size_t>(index));
  }
  Answer check_answer(int index, const CanFrame& frame, double* found) noexcept override {
    if (static_cast<int>(frame.id) != index) return Answer::kNone;
    *found = frame.data[0];
    return *found == index ? Answer::kRight : otherwise;
  }

  Answer otherwise = Answer::kWrong;

 private:
  std::vector<bool> readable_;
};

CanFrame answer(int step, int value) {
  CanFrame frame;
  frame.id = static_cast<std::uint32_t>(step);
  frame.data[0] = static_cast<std::uint8_t>(value);
  return frame;
}

class Watched : public ::testing::Test {
 protected:
  /// Identifier of the next request, -1 for none.
  int ask() {
    CanFrame frame;
    return watch.request(&frame) ? static_cast<int>(frame.id) : -1;
  }
  void answer_wrongly(int times) {
    for (int i = 0; i < times; ++i) {
      ASSERT_EQ(ask(), 2);
      ASSERT_TRUE(watch.receive(answer(2, 9)));
    }
  }

  FakeStartup startup{{false, false, true, false, true, false}};
  SettingsWatch watch{&startup};
};

TEST_F(Watched, WhatMayBeReadIsReadInTurn) {
  for (int step : {2, 4, 2, 4, 2}) {
    EXPECT_EQ(ask(), step);
    EXPECT_TRUE(watch.receive(answer(step, step)));
    EXPECT_FALSE(watch.changed());
  }
  watch.start();
  EXPECT_EQ(ask(), 2) << "from the beginning";
}

TEST_F(Watched, AFamilyWithNothingToBeReadIsAskedNothing) {
  FakeStartup nothing{{false, false}};
  FakeStartup no_steps{{}};
  for (FakeStartup* of : {&nothing, &no_steps}) {
    SettingsWatch empty(of);
    CanFrame frame;
    for (int i = 0; i < 5; ++i) EXPECT_FALSE(empty.request(&frame));
    for (int step = 0; step < 7; ++step) EXPECT_FALSE(empty.receive(answer(step, 99))) << step;
  }
}

TEST_F(Watched, OnlySettingsCanBeAsked) {
  FakeStartup last{{false, false, true}};
  SettingsWatch other(&last);
  CanFrame frame;
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(other.request(&frame));
    EXPECT_EQ(frame.id, 2U);
    EXPECT_TRUE(other.receive(answer(2, 2)));
  }
}

TEST_F(Watched, TwoWrongAnswersInARowAreAChange) {
  answer_wrongly(1);
  EXPECT_FALSE(watch.changed());
  EXPECT_EQ(watch.failure().reg, 0U);
  answer_wrongly(1);
  ASSERT_TRUE(watch.changed());
  EXPECT_EQ(watch.failure().reg, 102U);
  EXPECT_EQ(watch.failure().answer, Answer::kWrong);
  EXPECT_EQ(watch.failure().found, 9.0);
  EXPECT_EQ(watch.failure().expected, 2.0);
}

// A drive that is still on its way to a value that it should have.
TEST_F(Watched, NotYetIsWrong) {
  startup.otherwise = Answer::kNotYet;
  answer_wrongly(2);
  EXPECT_TRUE(watch.changed());
}

TEST_F(Watched, OneWrongAnswerIsForgottenWithTheNextRightOne) {
  for (int i = 0; i < 3; ++i) {
    answer_wrongly(1);
    EXPECT_EQ(ask(), 2) << "once more";
    watch.receive(answer(2, 2));
    EXPECT_EQ(ask(), 4);
    watch.receive(answer(4, 4));
  }
  EXPECT_FALSE(watch.changed());
}

TEST_F(Watched, WhatTheDriveDoesNotTellSaysNothing) {
  for (Answer none : {Answer::kRefused, Answer::kMissing}) {
    startup.otherwise = none;
    answer_wrongly(1);
    EXPECT_EQ(ask(), 4) << "the next one";
    watch.receive(answer(4, 4));
  }
  EXPECT_FALSE(watch.changed());
}

TEST_F(Watched, ALostAnswerIsAskedForAgain) {
  answer_wrongly(1);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(ask(), 2);
  EXPECT_FALSE(watch.changed());
  watch.receive(answer(2, 9));
  EXPECT_TRUE(watch.changed()) << "the second in a row";
}

TEST_F(Watched, AnAnswerThatComesTwiceCountsOnce) {
  EXPECT_EQ(ask(), 2);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(watch.receive(answer(2, 9)));
  EXPECT_FALSE(watch.changed());
}

TEST_F(Watched, OtherFramesAreNotTaken) {
  EXPECT_FALSE(watch.receive(answer(2, 2))) << "nobody asked";
  EXPECT_FALSE(watch.receive(answer(-1, 0))) << "nor is there such a step";
  EXPECT_EQ(ask(), 2);
  EXPECT_FALSE(watch.receive(answer(4, 4)));
  EXPECT_FALSE(watch.receive(answer(7, 7)));
  EXPECT_EQ(ask(), 2);
}

TEST_F(Watched, TheFirstChangeStaysUntilTheStartUpIsRepeated) {
  answer_wrongly(2);
  for (int value : {7, 7, 7, 2}) {
    EXPECT_EQ(ask(), 2);
    watch.receive(answer(2, value));
  }
  EXPECT_TRUE(watch.changed());
  EXPECT_EQ(watch.failure().found, 9.0);
  // Two more, elsewhere.
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(ask(), 4);
    watch.receive(answer(4, 8));
  }
  EXPECT_EQ(watch.failure().reg, 102U);
  watch.start();
  EXPECT_FALSE(watch.changed());
  EXPECT_FALSE(watch.receive(answer(4, 8)));
  answer_wrongly(1);
  EXPECT_FALSE(watch.changed()) << "counted from the beginning";
}

TEST_F(Watched, TheFirstStepMayBeASetting) {
  FakeStartup first{{true, true}};
  SettingsWatch other(&first);
  CanFrame frame;
  for (int time = 0; time < 2; ++time) {
    EXPECT_FALSE(other.receive(answer(0, 0))) << "nobody asked";
    ASSERT_TRUE(other.request(&frame));
    EXPECT_EQ(frame.id, 0U);
    EXPECT_TRUE(other.receive(answer(0, 0)));
    other.start();
  }
}

TEST_F(Watched, AStartWhileAnAnswerIsDueBeginsAtTheFirst) {
  EXPECT_EQ(ask(), 2);
  watch.start();
  EXPECT_EQ(ask(), 2);
}

}  // namespace
}  // namespace limber::test_settings_watch
