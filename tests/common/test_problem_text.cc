#include <gtest/gtest.h>

#include <set>
#include <string>

#include "common/problem_text.h"

namespace limber::test_problem_text {
namespace {

constexpr Problem kGroup[] = {{3, "who.SPILT", "the milk is spilt", "wipe it up"}};

TEST(ProblemText, HasCodePlaceDetailAndWhatToDo) {
  EXPECT_EQ(problem_text(kGroup, 3, "table 2", "0.5 l"),
            "who.SPILT: the milk is spilt (table 2): 0.5 l; wipe it up; see "
            "docs/troubleshooting.md");
  EXPECT_EQ(problem_text(kGroup, 3, "", ""),
            "who.SPILT: the milk is spilt; wipe it up; see docs/troubleshooting.md");
}

TEST(ProblemText, AnUnknownNumberIsToldAsSuch) {
  EXPECT_EQ(find_problem(kGroup, 4), nullptr);
  EXPECT_EQ(problem_text(kGroup, 4, "table 2", ""), "unknown number 4 (table 2)");
  EXPECT_EQ(refusal_text(-9, "no"), "unknown number -9: no");
}

TEST(ProblemText, ARefusalHasItsOwnReason) {
  const std::string text = refusal_text(request_answer_t::REFUSED_LEASE, "somebody has it");
  EXPECT_EQ(text.find("request.LEASE: somebody has it; "), 0U) << text;
}

TEST(ProblemText, ConstantsThatAreFineAreNoProblems) {
  EXPECT_EQ(find_problem(problems::kDriver, joint_state_t::FAULT_NONE), nullptr);
  EXPECT_EQ(find_problem(problems::kGate, driver_status_t::VERDICT_ACCEPTED), nullptr);
  EXPECT_EQ(find_problem(problems::kRequest, request_answer_t::REFUSED_NOTHING), nullptr);
  ASSERT_NE(find_problem(problems::kDriver, joint_state_t::FAULT_POSITION), nullptr);
  EXPECT_STREQ(find_problem(problems::kDriver, joint_state_t::FAULT_POSITION)->code,
               "driver.POSITION");
}

}  // namespace
}  // namespace limber::test_problem_text
