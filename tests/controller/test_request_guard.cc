// A recording is no request.
#include <gtest/gtest.h>

#include <cstdint>

#include "controller/request_guard.h"

namespace limber::test_request_guard {
namespace {

using Answer = request_answer_t;

constexpr std::int64_t kRun = 1234;

TEST(RequestGuard, TakesRisingNumbersOfEachClient) {
  RequestGuard guard(kRun);
  EXPECT_EQ(guard.check(kRun, 7, 10), nullptr);
  EXPECT_EQ(guard.check(kRun, 7, 11), nullptr);
  EXPECT_EQ(guard.check(kRun, 8, 1), nullptr) << "its own numbers";
  EXPECT_EQ(guard.check(kRun, 7, INT64_MAX), nullptr);
  EXPECT_NE(guard.check(kRun, 7, INT64_MAX), nullptr);
  EXPECT_EQ(guard.check(kRun, 9, INT64_MIN), nullptr);
}

TEST(RequestGuard, RefusesWhatWasReceivedBefore) {
  RequestGuard guard(kRun);
  for (std::int64_t seq : {5, 6, 9}) EXPECT_EQ(guard.check(kRun, 7, seq), nullptr);
  for (std::int64_t seq : {5, 6, 7, 9})
    EXPECT_EQ(guard.check(kRun, 7, seq).code, +Answer::REFUSED_REPEATED) << seq;
}

TEST(RequestGuard, RefusesWhatIsMeantForAnotherRun) {
  RequestGuard guard(kRun);
  EXPECT_EQ(guard.check(kRun + 1, 7, 1).code, +Answer::REFUSED_OTHER_RUN);
  EXPECT_EQ(guard.check(0, 7, 1).code, +Answer::REFUSED_OTHER_RUN);
  EXPECT_EQ(guard.check(kRun, 7, 1), nullptr) << "what was refused is not remembered";
  EXPECT_EQ(guard.check(kRun, 0, 2).code, +Answer::REFUSED_CLIENT);
}

TEST(RequestGuard, ForgetsNoClient) {
  RequestGuard guard(kRun);
  for (std::int64_t client = 1; client <= 64; ++client)
    EXPECT_EQ(guard.check(kRun, client, 5), nullptr) << client;
  EXPECT_EQ(guard.check(kRun, 65, 5).code, +Answer::REFUSED_CLIENT);
  for (std::int64_t client = 1; client <= 64; ++client) {
    EXPECT_NE(guard.check(kRun, client, 5), nullptr) << client;
    EXPECT_EQ(guard.check(kRun, client, 6), nullptr) << client;
  }
}

}  // namespace
}  // namespace limber::test_request_guard
