// A log on disk, plain and compressed, against LCM's own reader and zstd's own decoder.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zstd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "common/config_error.h"
#include "common/event_log.h"

namespace limber::test_event_log {
namespace {

namespace fs = std::filesystem;

constexpr int kEvents = 3000;
constexpr int kSize = 600;

/// What event i holds: a counter in each of its bytes, so that no two are alike.
std::string content(int i) { return std::string(kSize, static_cast<char>(i)) + std::to_string(i); }

class EventLogTest : public ::testing::Test {
 protected:
  EventLogTest() { fs::create_directory(folder_); }
  ~EventLogTest() override { fs::remove_all(folder_); }

  static void fill(EventLog& log) {
    for (int i = 0; i < kEvents; ++i) {
      const std::string data = content(i);
      log.write(1'000'000 + i, i % 2 == 0 ? "EVEN" : "ODD", data.data(),
                static_cast<std::int32_t>(data.size()));
    }
    log.close();
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  static std::string bytes(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  fs::path folder_ = fs::temp_directory_path() / ("limber_event_log_" + std::to_string(getpid()));
};

TEST_F(EventLogTest, LcmReadsAPlainLog) {
  EventLog log(path("a.lcmlog"));
  fill(log);
  lcm::LogFile reader(path("a.lcmlog"), "r");
  for (int i = 0; i < kEvents; ++i) {
    const lcm::LogEvent* event = reader.readNextEvent();
    ASSERT_NE(event, nullptr);
    EXPECT_EQ(event->eventnum, i);
    EXPECT_EQ(event->timestamp, 1'000'000 + i);
    EXPECT_EQ(event->channel, i % 2 == 0 ? "EVEN" : "ODD");
    EXPECT_EQ(std::string(static_cast<const char*>(event->data), event->datalen), content(i));
  }
  EXPECT_EQ(reader.readNextEvent(), nullptr);
  EXPECT_EQ(log.bytes_on_disk(), static_cast<std::int64_t>(fs::file_size(path("a.lcmlog"))));
}

TEST_F(EventLogTest, EachFrameOfACompressedLogIsWholeEventsWithAChecksum) {
  EventLog plain(path("a.lcmlog")), compressed(path("a.lcmlog.zst"));
  fill(plain);
  fill(compressed);
  const std::string packed = bytes(path("a.lcmlog.zst"));
  std::string unpacked;
  int frames = 0;
  for (std::size_t at = 0; at < packed.size(); ++frames) {
    const std::size_t frame = ZSTD_findFrameCompressedSize(&packed[at], packed.size() - at);
    ASSERT_FALSE(ZSTD_isError(frame));
    std::string block(ZSTD_getFrameContentSize(&packed[at], frame), '\0');
    ASSERT_EQ(ZSTD_decompress(block.data(), block.size(), &packed[at], frame), block.size());
    EXPECT_EQ(block.substr(0, 4), "\xED\xA1\xDA\x01");
    EXPECT_EQ(packed[at + 4] & 4, 4) << "the descriptor's bit for a checksum";
    unpacked += block;
    at += frame;
  }
  EXPECT_GT(frames, 5);
  EXPECT_EQ(unpacked, bytes(path("a.lcmlog")));
  EXPECT_LT(packed.size() * 10, unpacked.size());
}

TEST_F(EventLogTest, WhatWaitsIsWrittenWithinASecond) {
  EventLog log(path("a.lcmlog"));
  log.write(0, "A", "x", 1);
  for (int i = 0; i < 100 && log.bytes_on_disk() == 0; ++i) usleep(100'000);
  EXPECT_EQ(fs::file_size(path("a.lcmlog")), 28 + 1 + 1);
}

/// Far less than a block, again and again within the time that one may wait.
TEST_F(EventLogTest, WhatIsHurriedIsInTheFileAsSoonAsItIsSaidToBe) {
  EventLog plain(path("a.lcmlog")), compressed(path("a.lcmlog.zst"));
  for (int i = 0; i < 20; ++i) {
    for (EventLog* log : {&plain, &compressed}) {
      log->write(i, "A", "x", 1);
      const std::int64_t number = log->hurry();
      EXPECT_EQ(number, 30 * (i + 1));
      EXPECT_FALSE(log->stored(number + 1));
      while (!log->stored(number)) usleep(100);
    }
    EXPECT_EQ(fs::file_size(path("a.lcmlog")), 30U * (i + 1));
    EXPECT_EQ(static_cast<std::int64_t>(fs::file_size(path("a.lcmlog.zst"))),
              compressed.bytes_on_disk());
  }
}

TEST_F(EventLogTest, NothingIsOverwritten) {
  EventLog(path("a.lcmlog")).write(0, "A", "x", 1);
  EXPECT_THROW(EventLog{path("a.lcmlog")}, ConfigError);
  EXPECT_EQ(bytes(path("a.lcmlog")).size(), 30);
  EXPECT_NO_THROW(EventLog{"/dev/null"});
}

TEST_F(EventLogTest, SpaceIsLeftOnTheDisk) {
  constexpr std::int64_t kMoreThanAnyDisk = 1'000'000'000'000'000'000;
  EXPECT_THROW((EventLog{path("a.lcmlog"), kMoreThanAnyDisk}), ConfigError);
  EXPECT_FALSE(fs::exists(path("a.lcmlog")));
}

TEST_F(EventLogTest, AFullDiskIsTold) {
  EventLog log("/dev/full");
  log.offer(0, "A", "x", 1);
  EXPECT_THROW(log.close(), std::runtime_error);
  EXPECT_NE(log.failure().find("/dev/full"), std::string::npos);
  EXPECT_FALSE(log.offer(0, "A", "x", 1));
  EXPECT_THROW(log.write(0, "A", "x", 1), std::runtime_error);
}

/// A pipe that nobody reads is the slowest of disks.
TEST_F(EventLogTest, ASlowDiskCostsWhatDoesNotFitAndNothingElse) {
  const std::string fifo = path("slow");
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  const int reader = open(fifo.c_str(), O_RDONLY | O_NONBLOCK);
  auto log = std::make_unique<EventLog>(fifo);
  const std::vector<char> data(1 << 20U);
  std::size_t taken = 0;
  while (log->offer(0, "A", data.data(), 1 << 20U)) ++taken;
  EXPECT_GE(taken, 63);
  EXPECT_LE(taken, 66);
  EXPECT_EQ(log->failure(), "");

  fcntl(reader, F_SETFL, 0);
  std::size_t received = 0;
  std::thread drain([&] {
    std::vector<char> part(1 << 16U);
    for (ssize_t size; (size = read(reader, part.data(), part.size())) > 0;) received += size;
  });
  log->close();
  log.reset();  // the pipe's only writing end
  drain.join();
  close(reader);
  EXPECT_EQ(received, taken * (28 + 1 + (1 << 20U)));
}

}  // namespace
}  // namespace limber::test_event_log
