// The ring of the shared-memory arm plane: order, wrap-around, what is overwritten or torn,
// garbage.
#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <random>
#include <thread>
#include <vector>

#include "common/arm_plane/shared_memory_address.h"

namespace limber::test_shared_ring {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// A message whose bytes all follow from its number.
Bytes message(std::uint32_t number) {
  return Bytes(1 + number % ArmRing::kLongest, static_cast<std::uint8_t>(number));
}

class SharedRingTest : public testing::Test {
 protected:
  /// The next message; empty if none waits.
  static Bytes read(RingReader<ArmRing>& reader) {
    Bytes room(ArmRing::kLongest, 0xEE);
    const int size = reader.read(room);
    room.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
    return room;
  }
  ArmRing& ring() { return *memory_; }

 private:
  std::unique_ptr<ArmRing> memory_ = std::make_unique<ArmRing>();
};

TEST_F(SharedRingTest, MessagesOfAnyLengthComeInOrder) {
  RingWriter writer(&ring());
  RingReader reader(&ring());
  EXPECT_FALSE(reader.something_waits());
  EXPECT_EQ(read(reader), Bytes());
  for (std::uint32_t number = 0; number < 3 * ArmRing::kLongest; ++number) {
    ASSERT_TRUE(writer.write(message(number)));
    ASSERT_TRUE(reader.something_waits());
    ASSERT_EQ(read(reader), message(number)) << number;
  }
  EXPECT_EQ(read(reader), Bytes());
  EXPECT_EQ(reader.dropped(), 0);
  EXPECT_FALSE(writer.write(Bytes(ArmRing::kLongest + 1)));
  EXPECT_FALSE(reader.something_waits());
}

TEST_F(SharedRingTest, NumbersMayWrapAround) {
  ring().newest = 0U - 5;
  RingWriter writer(&ring());
  RingReader reader(&ring());
  for (std::uint32_t number = 0; number < 10; ++number) writer.write(message(number));
  for (std::uint32_t number = 0; number < 10; ++number) EXPECT_EQ(read(reader), message(number));
  EXPECT_EQ(reader.dropped(), 0);
}

TEST_F(SharedRingTest, WhatWasOverwrittenIsCounted) {
  RingWriter writer(&ring());
  RingReader reader(&ring());
  for (std::uint32_t number = 0; number < ArmRing::kSlots + 7; ++number)
    writer.write(message(number));
  for (std::uint32_t number = 7; number < ArmRing::kSlots + 7; ++number)
    EXPECT_EQ(read(reader), message(number));
  EXPECT_EQ(read(reader), Bytes());
  EXPECT_EQ(reader.dropped(), 7);
}

TEST_F(SharedRingTest, AMessageThatIsBeingWrittenIsNone) {
  RingWriter writer(&ring());
  RingReader reader(&ring());
  writer.write(message(1));
  writer.write(message(2));
  ring().slots[1].number =
      ArmRing::kSlots;  // as write() has it while message ArmRing::kSlots + 1 is written
  EXPECT_EQ(read(reader), message(2));
  EXPECT_EQ(reader.dropped(), 1);
}

TEST_F(SharedRingTest, AWriterThatDiedIsFollowedByTheNext) {
  RingReader reader(&ring());
  RingWriter(&ring()).write(message(1));
  ring().slots[2].number = 1;  // it died while it wrote the second
  RingWriter(&ring()).write(message(2));
  EXPECT_EQ(read(reader), message(1));
  EXPECT_EQ(read(reader), message(2));
  EXPECT_EQ(reader.dropped(), 0);
}

TEST_F(SharedRingTest, AReaderBeginsWithWhatComesAfterIt) {
  RingWriter writer(&ring());
  writer.write(message(1));
  RingReader reader(&ring());
  EXPECT_EQ(read(reader), Bytes());
  writer.write(message(2));
  EXPECT_EQ(read(reader), message(2));
}

TEST_F(SharedRingTest, TheSizeIsToldOfWhatDoesNotFit) {
  RingWriter writer(&ring());
  RingReader reader(&ring());
  writer.write(message(100));
  Bytes room(11, 0xEE);
  EXPECT_EQ(reader.read(std::span(room).first(10)), 101);
  EXPECT_EQ(room[9], 100);
  EXPECT_EQ(room[10], 0xEE);
}

/// Whatever stands in the memory: each call ends, no size above what a slot holds, nothing beyond
/// the room (address sanitizer), and after it messages come through again.
TEST_F(SharedRingTest, GarbageIsNoMessageThatDoesNotFitAndPasses) {
  std::mt19937_64 random(1);
  RingWriter writer(&ring());
  RingReader reader(&ring());
  for (int round = 0; round < 3000; ++round) {
    ring().newest = static_cast<std::uint32_t>(random());
    const bool near = round % 2 == 0;  // numbers that fit, with sizes that do not
    for (ArmRing::Slot& slot : ring().slots) {
      const auto offset = static_cast<std::uint32_t>(&slot - ring().slots.data());
      slot.number = near ? ring().newest / ArmRing::kSlots * ArmRing::kSlots + offset
                         : static_cast<std::uint32_t>(random());
      slot.bytes = static_cast<std::uint32_t>(random() >> (32 + random() % 32));
    }
    Bytes room(ArmRing::kLongest);
    std::uint32_t found = 0;
    for (int size = 0; (size = reader.read(room)) >= 0; ++found)
      ASSERT_LE(static_cast<std::size_t>(size), ArmRing::kLongest);
    ASSERT_LE(found, ArmRing::kSlots);
    writer.write(message(1));  // goes on with its own number
    RingReader next(&ring());
    writer.write(message(2));
    ASSERT_EQ(read(next), message(2));
    while (reader.read(room) >= 0) {
    }
    writer.write(message(3));
    ASSERT_EQ(read(reader), message(3));
  }
}

/// Each bit of number, size, check and bytes that flips: dropped and counted, and the next is read.
TEST_F(SharedRingTest, AMessageThatWasDamagedIsNone) {
  RingWriter writer(&ring());
  RingReader reader(&ring());
  constexpr std::uint32_t kSize = 37;
  std::int64_t damaged = 0;
  const auto expect_dropped = [&](auto&& damage) {
    writer.write(Bytes(kSize, 0x5A));
    damage(ring().slots[ring().newest % ArmRing::kSlots]);
    writer.write(message(3));
    ASSERT_EQ(read(reader), message(3));
    ASSERT_EQ(reader.dropped(), ++damaged);
  };
  for (std::uint32_t bit = 0; bit < 8 * kSize; ++bit)
    expect_dropped([&](ArmRing::Slot& slot) { slot.words[bit / 64] ^= 1ULL << bit % 64; });
  for (std::uint32_t bit = 0; bit < 64; ++bit)
    expect_dropped([&](ArmRing::Slot& slot) { slot.check ^= 1ULL << bit; });
  for (std::uint32_t bit = 0; bit < 32; ++bit) {
    expect_dropped([&](ArmRing::Slot& slot) { slot.bytes ^= 1U << bit; });
    expect_dropped([&](ArmRing::Slot& slot) { slot.number ^= 1U << bit; });
  }
}

/// Words exchanged within a message, one message's bytes under the next one's number, and a slot
/// that is all 0: all are words that a writer has written.
TEST_F(SharedRingTest, WordsOfAnotherPlaceAreNoMessage) {
  RingWriter writer(&ring());
  RingReader reader(&ring());
  Bytes bytes(64);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i);
  writer.write(bytes);
  ArmRing::Slot& exchanged = ring().slots[1];
  const std::uint64_t word = exchanged.words[2];
  exchanged.words[2] = exchanged.words[5].load();
  exchanged.words[5] = word;
  EXPECT_EQ(read(reader), Bytes());
  writer.write(bytes);
  ring().slots[3].bytes = ring().slots[2].bytes.load();
  ring().slots[3].check = ring().slots[2].check.load();
  for (std::size_t i = 0; i < 8; ++i) ring().slots[3].words[i] = ring().slots[2].words[i].load();
  ring().slots[3].number = 3;
  ring().newest = 3;
  EXPECT_EQ(read(reader), bytes);
  EXPECT_EQ(read(reader), Bytes()) << "the message before, again";
  ring().slots[4].number = 4;
  ring().newest = 4;
  EXPECT_EQ(read(reader), Bytes()) << "all 0";
  EXPECT_EQ(reader.dropped(), 3);
}

/// Random bytes all over the ring, numbers and sizes right: as when a program scribbles there.
TEST_F(SharedRingTest, RandomBytesAreNeverAMessage) {
  std::mt19937_64 random(2);
  RingReader reader(&ring());
  for (int round = 0; round < 200; ++round) {
    ring().newest += ArmRing::kSlots;
    for (std::uint32_t i = 0; i < ArmRing::kSlots; ++i) {
      const std::uint32_t number = ring().newest - i;
      ArmRing::Slot& slot = ring().slots[number % ArmRing::kSlots];
      slot.number = number;
      slot.bytes = static_cast<std::uint32_t>(random() % (ArmRing::kLongest + 1));
      slot.check = random();
      for (auto& word : slot.words) word = random();
    }
    ASSERT_EQ(read(reader), Bytes()) << round;
  }
  EXPECT_EQ(reader.dropped(), 200 * std::int64_t{ArmRing::kSlots});
}

/// A writer that is faster than the reader: the ring is overtaken all the time. Also under thread
/// sanitizer.
TEST_F(SharedRingTest, NoTornMessageIsReadWhileTheWriterOvertakes) {
  constexpr std::uint32_t kMessages = 200'000;
  RingReader reader(&ring());
  std::jthread thread([this] {
    RingWriter writer(&ring());
    Bytes bytes(400);
    for (std::uint32_t number = 1; number <= kMessages; ++number) {
      for (std::size_t i = 0; i < bytes.size(); i += 4) std::memcpy(&bytes[i], &number, 4);
      writer.write(bytes);
    }
  });
  std::uint32_t last = 0;
  std::int64_t received = 0;
  Bytes room(ArmRing::kLongest);
  while (last < kMessages) {
    if (reader.read(room) < 0) continue;
    std::uint32_t number = 0;
    std::memcpy(&number, room.data(), 4);
    ASSERT_GT(number, last);
    for (std::size_t i = 0; i < 400; i += 4) ASSERT_EQ(std::memcmp(&room[i], &number, 4), 0);
    last = number;
    ++received;
  }
  EXPECT_EQ(received + reader.dropped(), kMessages);
}

}  // namespace
}  // namespace limber::test_shared_ring
