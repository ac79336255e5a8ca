// A log whose reader hangs stops nobody.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <spdlog/logger.h>
#include <unistd.h>

#include <array>
#include <memory>
#include <string>

#include "common/log_sink.h"

namespace limber::test_log_sink {
namespace {

class LogSinkTest : public ::testing::Test {
 protected:
  LogSinkTest() {
    EXPECT_EQ(pipe(ends_.data()), 0);
    EXPECT_GE(fcntl(ends_[1], F_SETPIPE_SZ, 4096), 4096);
    fcntl(ends_[0], F_SETFL, O_NONBLOCK);
    logger_ = std::make_unique<spdlog::logger>("", std::make_shared<LogSink>(ends_[1]));
    logger_->set_pattern("%v");
  }
  ~LogSinkTest() override {
    for (int end : ends_) close(end);
  }
  std::string read_all() const {
    std::string all;
    std::array<char, 4096> part;
    for (ssize_t size; (size = read(ends_[0], part.data(), part.size())) > 0;)
      all.append(part.data(), static_cast<std::size_t>(size));
    return all;
  }

  std::array<int, 2> ends_{};
  std::unique_ptr<spdlog::logger> logger_;
};

TEST_F(LogSinkTest, LinesArriveWhole) {
  logger_->info("one");
  EXPECT_EQ(read_all(), "one\n");
  logger_->warn("two");
  EXPECT_EQ(read_all(), "two\n");
}

TEST_F(LogSinkTest, WhatFindsNoRoomIsLeftOutAndCounted) {
  logger_->info("first");  // a pipe of one page is ready when it is empty
  for (int i = 0; i < 9; ++i) logger_->info("lost");
  EXPECT_EQ(read_all(), "first\n");
  logger_->info("next");
  EXPECT_EQ(read_all(), "(9 log lines left out: nobody read them)\nnext\n");
  logger_->info("after");
  EXPECT_EQ(read_all(), "after\n");
}

}  // namespace
}  // namespace limber::test_log_sink
