// Only one process drives a bus.
#include <gtest/gtest.h>
#include <unistd.h>

#include <string>
#include <utility>

#include "common/config_error.h"
#include "common/run_lock.h"

namespace limber::test_run_lock {
namespace {

std::string name(const char* what) { return std::string(what) + " " + std::to_string(getpid()); }

TEST(RunLock, IsHeldOnceAndFreeAtTheEnd) {
  const std::string what = name("driver of test bus");
  for (int round = 0; round < 2; ++round) {
    RunLock first(what);
    RunLock moved(std::move(first));
    try {
      RunLock second(what);
      FAIL() << "held twice";
    } catch (const ConfigError& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find(what), std::string::npos) << text;
      EXPECT_NE(text.find("process " + std::to_string(getpid())), std::string::npos) << text;
    }
    RunLock other(name("driver of another bus"));
  }
}

TEST(RunLock, ANameThatDoesNotFitIsRefused) {
  EXPECT_THROW(RunLock(std::string(200, 'x')), ConfigError);
}

}  // namespace
}  // namespace limber::test_run_lock
