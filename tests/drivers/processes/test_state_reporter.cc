#include <gtest/gtest.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include "common/tell.h"
#include "drivers/processes/state_reporter.h"

namespace limber::test_state_reporter {
namespace {

/// What is logged while it lives; a test may read it while the reporter's thread writes.
class Captured {
 public:
  Captured() {
    auto logger = std::make_shared<spdlog::logger>("", sink_);
    logger->set_pattern("%v");
    spdlog::set_default_logger(logger);
  }
  ~Captured() { spdlog::set_default_logger(before_); }
  std::string text() const { return sink_->text(); }

 private:
  class Sink : public spdlog::sinks::base_sink<std::mutex> {
   public:
    std::string text() {
      const std::scoped_lock lock(mutex_);
      return text_;
    }

   private:
    void sink_it_(const spdlog::details::log_msg& message) override {
      spdlog::memory_buf_t line;
      formatter_->format(message, line);
      text_.append(line.data(), line.size());
    }
    void flush_() override {}
    std::string text_;
  };

  std::shared_ptr<spdlog::logger> before_ = spdlog::default_logger();
  std::shared_ptr<Sink> sink_ = std::make_shared<Sink>();
};

joint_state_t state(std::int8_t drives, std::int8_t fault = joint_state_t::FAULT_NONE) {
  joint_state_t state{};
  state.drive_state = drives;
  state.fault = fault;
  state.fault_joint = fault == joint_state_t::FAULT_NONE ? -1 : 0;
  return state;
}

/// A cycle each: no round of the reporter's lies between them.
TEST(StateReporter, AFaultOfASingleCycleIsTold) {
  Captured log;
  std::vector<std::string> faults;
  StateReporter reporter({"elbow"});
  reporter.set_fault_text(
      [](int, int, std::uint16_t detail) { return "detail " + std::to_string(detail); });
  reporter.set_on_fault([&](const char* code) { faults.emplace_back(code); });
  reporter.note(state(joint_state_t::DRIVE_ENABLING));
  reporter.note(state(joint_state_t::DRIVE_FAULT, joint_state_t::FAULT_DRIVE_ERROR), 7);
  reporter.note(state(joint_state_t::DRIVE_CONFIGURING));
  reporter.note(state(joint_state_t::DRIVE_OFF));
  reporter.stop();
  const std::string text = log.text();
  const std::size_t enabling = text.find("drives: enabling");
  const std::size_t fault = text.find("drives: fault: driver.DRIVE_ERROR");
  const std::size_t off = text.find("drives: off");
  ASSERT_NE(fault, std::string::npos) << text;
  EXPECT_NE(text.find("(elbow): detail 7"), std::string::npos) << text;
  EXPECT_LT(enabling, fault);
  EXPECT_LT(fault, text.find("drives: configuring"));
  EXPECT_LT(fault, off);
  EXPECT_EQ(faults, std::vector<std::string>{"driver.DRIVE_ERROR"});
}

TEST(StateReporter, TheLastStateIsToldHoweverManyCameAtOnce) {
  Captured log;
  StateReporter reporter({"elbow"});
  for (int i = 0; i < 10'000; ++i) {
    reporter.note(state(i % 2 == 0 ? joint_state_t::DRIVE_OFF : joint_state_t::DRIVE_ENABLING));
  }
  for (int i = 0; i < 1'000'000 && log.text().find("drives: on") == std::string::npos; ++i) {
    reporter.note(state(joint_state_t::DRIVE_ON));
    if (i % 100 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  reporter.stop();
  EXPECT_NE(log.text().find("drives: on"), std::string::npos);
}

// Whatever of a line finds no memory: the driver holds the arm meanwhile.
TEST(StateReporter, ALineWithoutMemoryIsLostAndCounted) {
  Captured log;
  StateReporter reporter({"elbow"});
  std::atomic<bool> memory = false;
  std::atomic<int> lost = 0;
  const auto need_memory = [&] {
    if (memory) return;
    ++lost;
    throw std::bad_alloc();
  };
  reporter.set_fault_text([&](int, int, std::uint16_t) {
    need_memory();
    return std::string("detail");
  });
  reporter.set_warning_text([&](int, const DriveWarning&) {
    need_memory();
    return std::string("warm");
  });
  DriveWarning hot;
  hot.hot = true;
  reporter.note_warning(0, hot);
  reporter.note(state(joint_state_t::DRIVE_HOLD, joint_state_t::FAULT_REPLY_LOST));
  for (int i = 0; i < 2000 && lost < 2; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ASSERT_EQ(lost, 2) << "each once";
  memory = true;
  reporter.note(state(joint_state_t::DRIVE_FAULT, joint_state_t::FAULT_DRIVE_ERROR));
  reporter.stop();
  EXPECT_NE(log.text().find("lost for want of memory"), std::string::npos) << log.text();
  EXPECT_NE(log.text().find("driver.DRIVE_ERROR"), std::string::npos) << log.text();
  EXPECT_EQ(lines_lost, 0);
}

TEST(StateReporter, APauseOfTheProcessIsTold) {
  Captured log;
  StateReporter reporter({"elbow"});
  reporter.note_stall(212'000'000);
  reporter.stop();
  EXPECT_NE(log.text().find("warning: limber-driver stood still for 212 ms"), std::string::npos)
      << log.text();
}

}  // namespace
}  // namespace limber::test_state_reporter
