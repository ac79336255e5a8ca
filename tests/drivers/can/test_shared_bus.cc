// The virtual bus in shared memory: what it does not have in common with the one over sockets.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "common/clock.h"
#include "common/config_error.h"
#include "drivers/can/shared_bus.h"

namespace limber::test_shared_bus {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

CanFrame frame_of(std::uint32_t id) {
  CanFrame frame;
  frame.id = id;
  frame.length = 2;
  frame.timestamp_ns = 1000 + id;
  return frame;
}

class SharedBus : public ::testing::Test {
 protected:
  void SetUp() override { remove(); }
  void TearDown() override { remove(); }

  static std::unique_ptr<CanBus> join(Stamps stamps = Stamps::kOnArrival) {
    return open_shared_bus(kName, true, stamps, {});
  }
  static std::string path() { return shared_bus_path(kName); }
  static void remove() {
    std::filesystem::remove(path());
    for (std::size_t end = 0; end < kSharedBusEnds; ++end)
      std::filesystem::remove(path() + "." + std::to_string(end));
  }
  static bool hears(CanBus* bus, std::int64_t timeout_ns) {
    return wait_readable(std::span(&bus, 1), monotonic_ns() + timeout_ns);
  }
  /// Sleeps until a frame has come, however often it is woken in vain; false after 20 s without.
  static bool next(CanBus* bus, CanFrame* frame) {
    while (bus->receive(std::span(frame, 1)) == 0)
      if (!hears(bus, 20 * kSecond)) return false;
    return true;
  }
  static void expect_refusal(const std::string& reason) {
    try {
      join();
      ADD_FAILURE() << "not refused: " << reason;
    } catch (const ConfigError& error) {
      EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("virtual:shared_bus_test"), std::string::npos);
    }
  }
  static SharedBusMemory* map() {
    const int file = open(path().c_str(), O_RDWR);
    void* memory =
        mmap(nullptr, sizeof(SharedBusMemory), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    close(file);
    return static_cast<SharedBusMemory*>(memory);
  }

  static constexpr const char* kName = "shared_bus_test";
};

TEST_F(SharedBus, StampsOfTheSenderWhereTheyAreWanted) {
  const auto sender = join();
  const auto receiver = join(Stamps::kOfSender);
  sender->send(frame_of(5));
  CanFrame frame;
  ASSERT_EQ(receiver->receive(std::span(&frame, 1)), 1);
  EXPECT_EQ(frame.timestamp_ns, 1005);
}

TEST_F(SharedBus, AnEndThatEndsLeavesItsPlaceAndWhatItHasSentToThoseWhoHaveNotReadIt) {
  const auto receiver = join();
  std::array<CanFrame, 4> frames;
  for (std::uint32_t life = 1; life <= 3 * kSharedBusEnds; ++life) {
    join()->send(frame_of(life));
    ASSERT_EQ(receiver->receive(frames), 1);
    EXPECT_EQ(frames[0].id, life);
  }
  join()->send(frame_of(1));
  const auto late = join();
  EXPECT_EQ(late->receive(frames), 0) << "sent before it came";
}

TEST_F(SharedBus, HasAnEndForEachProgramAndNoMore) {
  std::vector<std::unique_ptr<CanBus>> ends;
  while (ends.size() < kSharedBusEnds) ends.push_back(join());
  expect_refusal("all 8 ends are taken by other programs");
  ends.pop_back();
  EXPECT_NE(join(), nullptr);
}

TEST_F(SharedBus, ASleeperIsWokenByAnotherProcess) {
  const auto bus = join();
  const pid_t sender = fork();
  if (sender == 0) {
    const auto other = join();
    usleep(20'000);
    other->send(frame_of(1));
    _exit(0);
  }
  const std::int64_t start_ns = monotonic_ns();
  EXPECT_TRUE(hears(bus.get(), 20 * kSecond));
  EXPECT_LT(monotonic_ns() - start_ns, 10 * kSecond);
  waitpid(sender, nullptr, 0);
  CanFrame frame;
  EXPECT_EQ(bus->receive(std::span(&frame, 1)), 1);
}

TEST_F(SharedBus, NoFrameIsSleptThrough) {
  const auto ping = join();
  const auto pong = join();
  constexpr std::uint32_t kRounds = 3000;
  std::jthread answerer([&pong] {
    CanFrame frame;
    for (std::uint32_t round = 0; round < kRounds && next(pong.get(), &frame); ++round)
      pong->send(frame);
  });
  CanFrame frame;
  for (std::uint32_t round = 0; round < kRounds; ++round) {
    ping->send(frame_of(round % kStandardIdMax));
    ASSERT_TRUE(next(ping.get(), &frame)) << round;
    ASSERT_EQ(frame.id, round % kStandardIdMax);
  }
}

TEST_F(SharedBus, OfManyFramesToASleeperOneWakesIt) {
  const auto sender = join();
  const auto receiver = join();
  receiver->about_to_sleep();
  for (std::uint32_t id = 0; id < 20; ++id) sender->send(frame_of(id));
  std::array<char, 8> bytes{};
  EXPECT_EQ(read(receiver->descriptor(), bytes.data(), bytes.size()), 1);
}

TEST_F(SharedBus, AWakeThatIsLeftOverWakesOnlyOnce) {
  const auto sender = join();
  const auto receiver = join();
  receiver->about_to_sleep();
  sender->send(frame_of(1));
  CanFrame frame;
  ASSERT_EQ(receiver->receive(std::span(&frame, 1)), 1);
  EXPECT_FALSE(hears(receiver.get(), kSecond / 50));
}

// Of a sender that was held up between its frame, which was read without sleep, and its byte.
TEST_F(SharedBus, AWakeMayComeWithoutAFrame) {
  const auto receiver = join();
  const auto sender = join();
  std::jthread late([&] {
    usleep(20'000);
    EXPECT_EQ(write(receiver->descriptor(), "", 1), 1);
  });
  CanFrame frame;
  EXPECT_TRUE(hears(receiver.get(), 20 * kSecond));
  EXPECT_EQ(receiver->receive(std::span(&frame, 1)), 0);
  sender->send(frame_of(3));
  ASSERT_TRUE(next(receiver.get(), &frame));
  EXPECT_EQ(frame.id, 3U);
}

// Of one who can write a record, but no frame.
std::uint64_t check_of(const FrameRing::Slot& slot) {
  RingCheck check(slot.number, slot.bytes);
  for (std::size_t i = 0; i < slot.words.size() && 8 * i < slot.bytes; ++i)
    check.add(slot.words[i]);
  return check.value();
}

TEST_F(SharedBus, GarbageIsNoFrameAndPasses) {
  const auto bus = join();
  SharedBusMemory* memory = map();
  std::mt19937 random(1);
  for (int round = 0; round < 200; ++round) {
    FrameRing& ring = memory->ends[1 + random() % (kSharedBusEnds - 1)].ring;
    for (FrameRing::Slot& slot : ring.slots) {
      slot.number = random() % 4 == 0 ? random() : ring.newest + random() % FrameRing::kSlots;
      slot.bytes = random() % 2 == 0 ? random() : random() % FrameRing::kLongest;
      for (auto& word : slot.words) word = random();
      slot.check = random() % 2 == 0 ? random() : check_of(slot);
    }
    ring.newest = random() % 2 == 0 ? random() : ring.newest + random() % FrameRing::kSlots;
    memory->ends[0].asleep = random();
    CanFrame frame;
    std::size_t found = 0;
    while (bus->receive(std::span(&frame, 1)) == 1) {
      EXPECT_TRUE(is_possible(frame));
      ASSERT_LE(++found, kSharedBusEnds * FrameRing::kSlots);
    }
  }
  EXPECT_GT(bus->statistics().malformed, 0);
  EXPECT_GT(bus->statistics().overflow, 0);
  munmap(memory, sizeof(SharedBusMemory));
  const auto peer = join();
  const std::int64_t before = bus->statistics().received;
  peer->send(frame_of(7));
  CanFrame frame;
  ASSERT_EQ(bus->receive(std::span(&frame, 1)), 1);
  EXPECT_EQ(frame.id, 7U);
  EXPECT_EQ(bus->statistics().received, before + 1);
}

TEST_F(SharedBus, MemoryThatOthersMayWriteToIsRefused) {
  close(open(path().c_str(), O_RDWR | O_CREAT, 0600));
  expect_refusal("was made by another version of limber");
  chmod(path().c_str(), 0666);
  expect_refusal("is writable for others");
  remove();
  ASSERT_EQ(mkdir(path().c_str(), 0700), 0);
  expect_refusal("cannot be opened");
}

TEST_F(SharedBus, AFifoThatIsNoneOrThatOthersMayWriteToIsRefused) {
  const std::string fifo = path() + ".3";
  close(open(fifo.c_str(), O_RDWR | O_CREAT, 0600));
  expect_refusal(fifo + " is no FIFO");
  std::filesystem::remove(fifo);
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  chmod(fifo.c_str(), 0622);
  expect_refusal("is writable for others");
}

}  // namespace
}  // namespace limber::test_shared_bus
