// What the sender and the bus below each see of frames that are changed, lost or replaced.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "drivers/can/memory_bus.h"
#include "qa/faults/tampered_bus.h"

namespace limber::test_tampered_bus {
namespace {

class Tampered : public ::testing::Test {
 protected:
  static CanFrame frame(std::uint32_t id, std::uint8_t byte) {
    CanFrame made;
    made.id = id;
    made.length = 1;
    made.data[0] = byte;
    return made;
  }

  std::vector<CanFrame> heard() {
    std::vector<CanFrame> frames;
    CanFrame one;
    while (other_->receive(std::span(&one, 1)) == 1) frames.push_back(one);
    return frames;
  }

  MemoryBus bus_;
  std::unique_ptr<CanBus> mine_ = bus_.attach();
  std::unique_ptr<CanBus> other_ = bus_.attach();
  faults::TamperedBus tampered_{mine_.get()};
};

TEST_F(Tampered, LetsFramesPassAsTheyAre) {
  EXPECT_EQ(tampered_.send(frame(1, 7)), 1);
  const auto frames = heard();
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].data[0], 7);
}

TEST_F(Tampered, SentFramesAreChanged) {
  tampered_.set_sent_change([](const CanFrame& sent) {
    CanFrame changed = sent;
    changed.data[0] = 0xAA;
    return std::optional(changed);
  });
  EXPECT_EQ(tampered_.send(frame(1, 7)), 1);
  const auto frames = heard();
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].id, 1U);
  EXPECT_EQ(frames[0].data[0], 0xAA);
}

TEST_F(Tampered, SentFramesAreLostWithoutTheSendersKnowledge) {
  tampered_.set_sent_change(
      [](const CanFrame& sent) { return sent.id == 1 ? std::nullopt : std::optional(sent); });
  EXPECT_EQ(tampered_.send(frame(1, 7)), 1);
  EXPECT_EQ(tampered_.send(frame(2, 8)), 1);
  EXPECT_EQ(tampered_.statistics().send_refused, 0);
  const auto frames = heard();
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].id, 2U);
}

TEST_F(Tampered, OneFrameOfAnIdentifierIsReplaced) {
  tampered_.replace_sent([](const CanFrame& sent) { return has_id(sent, 1); }, frame(1, 0xBB));
  for (const std::uint32_t id : {2U, 1U, 1U}) EXPECT_EQ(tampered_.send(frame(id, 7)), 1);
  const auto frames = heard();
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[0].data[0], 7);
  EXPECT_EQ(frames[1].data[0], 0xBB);
  EXPECT_EQ(frames[2].data[0], 7);
}

TEST_F(Tampered, AFullQueueTakesNothingAndSaysSo) {
  tampered_.refuse_sends();
  EXPECT_EQ(tampered_.send(frame(1, 7)), 0);
  EXPECT_EQ(tampered_.statistics().send_refused, 1);
  EXPECT_TRUE(heard().empty());
}

}  // namespace
}  // namespace limber::test_tampered_bus
