// The ring of LCM log records: its bytes, what is left after it went round, several writers; and
// the box around it: a copy after a fault, and what a killed process leaves.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "common/black_box/black_box.h"
#include "tests/support/mutation.h"

namespace limber::test_black_box {
namespace {

namespace fs = std::filesystem;

using Bytes = std::vector<std::uint8_t>;

Bytes bytes(std::string_view text) { return {text.begin(), text.end()}; }

std::int64_t big_endian(const std::uint8_t* data, int size) {
  std::int64_t value = 0;
  for (int i = 0; i < size; ++i) value = value << 8 | data[i];
  return value;
}

/// Number -> data of every record in a ring; the file format read once more, by hand.
std::map<std::int64_t, std::string> records(std::span<const std::uint8_t> ring) {
  std::map<std::int64_t, std::string> found;
  std::size_t at = 0;
  while (at + EventRing::kHeaderBytes <= ring.size()) {
    if (std::memcmp(ring.data() + at, "\xED\xA1\xDA\x01", 4) != 0) {
      at += 8;
      continue;
    }
    const std::int64_t name = big_endian(ring.data() + at + 20, 4);
    const std::int64_t size = big_endian(ring.data() + at + 24, 4);
    const auto* data = ring.data() + at + EventRing::kHeaderBytes + name;
    found[big_endian(ring.data() + at + 4, 8)] = std::string(data, data + size);
    at += static_cast<std::size_t>(28 + name + size + 7) / 8 * 8;
  }
  return found;
}

TEST(EventRing, WritesRecordsOfAnLcmLog) {
  alignas(8) std::array<std::uint8_t, 512> memory{};
  EventRing ring(memory);
  ring.write("AB", 0x0102030405060708, bytes("xyz"));
  ring.write("C", 5, bytes("w"));
  const Bytes first =
      bytes(std::string_view("\xED\xA1\xDA\x01"
                             "\0\0\0\0\0\0\0\0"
                             "\x01\x02\x03\x04\x05\x06\x07\x08"
                             "\0\0\0\x02"
                             "\0\0\0\x03"
                             "ABxyz\0\0\0",
                             36));
  EXPECT_EQ(Bytes(memory.begin(), memory.begin() + 36), first);
  EXPECT_EQ(std::memcmp(memory.data() + 40, "\xED\xA1\xDA\x01\0\0\0\0\0\0\0\1", 12), 0);
}

TEST(EventRing, KeepsTheNewestWhenItGoesRound) {
  alignas(8) std::array<std::uint8_t, 1024> memory{};
  EventRing ring(memory);
  for (int i = 0; i < 1000; ++i) {
    const std::string text = std::to_string(i) + std::string(static_cast<std::size_t>(i % 40), 'x');
    ring.write("N", i, bytes(text));
    const auto found = records(memory);
    ASSERT_EQ(found.rbegin()->first, i);
    ASSERT_EQ(found.rbegin()->second, text);
    // Without a gap back to the oldest: at most 80 bytes a record, and a gap at the end.
    ASSERT_EQ(found.rbegin()->first - found.begin()->first + 1, std::ssize(found));
    if (i > 20) {
      ASSERT_GE(found.size(), (1024U - 80) / 80 - 1);
    }
  }
}

TEST(EventRing, WhatIsTooLongIsLeftOut) {
  alignas(8) std::array<std::uint8_t, 800> memory{};
  EventRing ring(memory);
  ring.write("N", 0, Bytes(100 - 28));
  EXPECT_TRUE(records(memory).empty());
  ring.write("N", 0, Bytes(100 - 28 - 5));
  EXPECT_EQ(records(memory).size(), 1U);
}

TEST(EventRing, TakesSeveralWriters) {
  std::vector<std::uint64_t> memory(1 << 15);
  const std::span<std::uint8_t> span(reinterpret_cast<std::uint8_t*>(memory.data()),
                                     8 * memory.size());
  EventRing ring(span);
  std::vector<std::jthread> threads;
  for (int t = 0; t < 3; ++t)
    threads.emplace_back([&ring, t] {
      for (int i = 0; i < 1000; ++i)
        ring.write("T", i, Bytes(static_cast<std::size_t>(1 + (i + t) % 30), 'a'));
    });
  threads.clear();
  const auto found = records(span);
  EXPECT_EQ(found.size(), 3000U);
  for (const auto& [number, data] : found) ASSERT_EQ(data, std::string(data.size(), 'a')) << number;
}

class BlackBoxTest : public ::testing::Test {
 protected:
  BlackBoxTest() { setenv("LIMBER_BLACK_BOXES", folder_.c_str(), 1); }
  ~BlackBoxTest() override { unsetenv("LIMBER_BLACK_BOXES"); }
  /// The only kept box whose name contains `part`; waits for its bytes.
  Bytes kept(const std::string& part) const {
    for (int i = 0; i < 1000; ++i) {
      for (const auto& entry : fs::directory_iterator(folder_)) {
        if (entry.path().string().find(part) == std::string::npos) continue;
        std::ifstream in(entry.path(), std::ios::binary);
        Bytes content{std::istreambuf_iterator<char>(in), {}};
        if (content.size() == BlackBox::kHeaderBytes + kLeast) return content;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return {};
  }
  static std::map<std::int64_t, std::string> records_of(const Bytes& content) {
    return records(std::span(content).subspan(BlackBox::kHeaderBytes));
  }

  static constexpr std::size_t kLeast = 1 << 20;  ///< bytes of a ring, at these low rates

  const testing::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
  const std::string name_ = "test-" + std::to_string(getpid());
};

TEST_F(BlackBoxTest, KeepsWhatCameBeforeAndAfterAFault) {
  BlackBox box(name_, 10.0);
  box.write("A", bytes("before"));
  box.keep("driver.VELOCITY");
  box.keep("driver.BUS");  // while one is under way
  box.write("A", bytes("after"));
  const Bytes content = kept("-" + name_ + "-driver.VELOCITY.box");
  ASSERT_FALSE(content.empty());
  EXPECT_EQ(std::string(content.begin(), content.begin() + 18), "limber-black-box/1");
  const auto found = records_of(content);
  EXPECT_EQ(found, (std::map<std::int64_t, std::string>{{0, "before"}, {1, "after"}}));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(BlackBoxTest, AnEndInOrderFinishesTheCopyAndLeavesNothing) {
  {
    BlackBox box(name_, 10.0);
    box.write("A", bytes("x"));
    box.keep("driver.BUS");
  }
  EXPECT_EQ(records_of(kept("driver.BUS")).size(), 1U);
  { BlackBox again(name_, 10.0); }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(BlackBoxTest, AKilledProcessLeavesItsLastSeconds) {
  const pid_t child = fork();
  if (child == 0) {
    BlackBox box(name_, 10.0);
    box.write("A", bytes("last words"));
    kill(getpid(), SIGKILL);
  }
  waitpid(child, nullptr, 0);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 0);
  const BlackBox next(name_, 10.0);
  EXPECT_EQ(records_of(kept("-killed.box")),
            (std::map<std::int64_t, std::string>{{0, "last words"}}));
}

TEST_F(BlackBoxTest, TwoOfOneNameHaveAFileEach) {
  BlackBox one(name_, 10.0);
  BlackBox two(name_, 10.0);
  one.write("A", bytes("one"));
  two.write("A", bytes("two"));
  one.keep("first");
  two.keep("second");
  EXPECT_EQ(records_of(kept("-first.box")).at(0), "one");
  EXPECT_EQ(records_of(kept("-second.box")).at(0), "two");
}

TEST_F(BlackBoxTest, OnlySoManyStay) {
  for (int i = 0; i < BlackBox::kMostCopies + 5; ++i)
    std::ofstream(folder_ / ("20200101T0000" + std::to_string(10 + i) + "-driver-x-y.box"))
        << "old";
  {
    BlackBox box(name_, 10.0);
    box.write("A", bytes("x"));
    box.keep("new");
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), BlackBox::kMostCopies);
  EXPECT_FALSE(kept("-new.box").empty());
}

TEST_F(BlackBoxTest, CanBeSwitchedOff) {
  setenv("LIMBER_BLACK_BOX", "off", 1);
  {
    BlackBox box(name_, 10.0);
    box.write("A", bytes("x"));
    box.keep("none");
  }
  unsetenv("LIMBER_BLACK_BOX");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 0);
}

TEST_F(BlackBoxTest, AFolderThatCannotBeMadeIsNoReasonNotToRun) {
  setenv("LIMBER_BLACK_BOXES", "/proc/nothing/here", 1);
  BlackBox box(name_, 10.0);
  box.write("A", bytes("x"));
  box.keep("lost");
}

}  // namespace
}  // namespace limber::test_black_box
