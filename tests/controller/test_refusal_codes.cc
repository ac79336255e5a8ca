// What is refused has the code of its kind, and a scenario's refusals can be seen.
#include <gtest/gtest.h>

#include <vector>

#include "controller/controller_log.h"
#include "controller/request_guard.h"
#include "tests/controller/arms.h"
#include "tests/controller/rig.h"

namespace limber::test_refusal_codes {
namespace {

using Refused = request_answer_t;
using limber::testing::Rig;

int code_of(const Refusal& refusal) { return refusal.code; }

TEST(RefusalCodes, OfGoals) {
  Rig rig(limber::testing::random_arm(7, 5, true));
  rig.to_active();
  compliance_goal_t goal = rig.goal();
  EXPECT_EQ(code_of(rig.controller.on_goal(goal)), +Refused::REFUSED_NOTHING);
  goal.offset[0] = 11.0;
  EXPECT_EQ(code_of(rig.controller.on_goal(goal)), +Refused::REFUSED_GOAL_LIMIT);
  goal.kind = compliance_goal_t::GOAL_JOINT;
  EXPECT_EQ(code_of(rig.controller.on_goal(goal)), +Refused::REFUSED_GOAL_KIND);
  goal.kind = 17;
  EXPECT_EQ(code_of(rig.controller.on_goal(goal)), +Refused::REFUSED_MALFORMED);
  goal = rig.goal();
  goal.client = 0;
  EXPECT_EQ(code_of(rig.controller.on_goal(goal)), +Refused::REFUSED_CLIENT);
  goal.client = rig.goal().client + 1;
  EXPECT_EQ(code_of(rig.controller.on_goal(goal)), +Refused::REFUSED_LEASE);
  rig.request(mode_request_t::REQUEST_HOLD);
  EXPECT_EQ(code_of(rig.controller.on_goal(rig.goal())), +Refused::REFUSED_MODE);
}

TEST(RefusalCodes, OfGains) {
  Rig rig(limber::testing::random_arm(7, 5, true));
  rig.to_active();
  compliance_gains_t gains = rig.gains();
  EXPECT_EQ(code_of(rig.controller.on_gains(gains)), +Refused::REFUSED_NOTHING);
  gains.law = "admittance";  // without a source of the contact
  EXPECT_EQ(code_of(rig.controller.on_gains(gains)), +Refused::REFUSED_LAW);
  gains.law = "magic";
  EXPECT_EQ(code_of(rig.controller.on_gains(gains)), +Refused::REFUSED_MALFORMED);
  gains.K_x[0][0] = -1.0;
  EXPECT_EQ(code_of(rig.controller.on_gains(gains)), +Refused::REFUSED_GAINS_RANGE);
}

TEST(RefusalCodes, OfModesAndSenders) {
  Rig rig(limber::testing::random_arm(7, 5, true));
  rig.step();
  mode_request_t request{};
  request.client = 5;
  request.request = mode_request_t::REQUEST_ACTIVE;
  EXPECT_EQ(code_of(rig.controller.on_mode(request)), +Refused::REFUSED_MODE);
  request.request = mode_request_t::REQUEST_ACKNOWLEDGE;
  EXPECT_EQ(code_of(rig.controller.on_mode(request)), +Refused::REFUSED_CAUSE_REMAINS);
  request.request = 99;
  EXPECT_EQ(code_of(rig.controller.on_mode(request)), +Refused::REFUSED_MALFORMED);
  RequestGuard guard(7);
  EXPECT_EQ(code_of(guard.check(8, 5, 1)), +Refused::REFUSED_OTHER_RUN);
  EXPECT_EQ(code_of(guard.check(7, 0, 1)), +Refused::REFUSED_CLIENT);
  EXPECT_EQ(code_of(guard.check(7, 5, 1)), +Refused::REFUSED_NOTHING);
  EXPECT_EQ(code_of(guard.check(7, 5, 1)), +Refused::REFUSED_REPEATED);
}

TEST(RefusalCodes, ATimelinesOutcomesAreThoseOfItsCycle) {
  mode_request_t hold{};
  hold.client = kScenarioClient;
  hold.seq = 1;
  hold.request = mode_request_t::REQUEST_HOLD;
  compliance_goal_t goal{};  // the arm is in HOLD
  goal.client = kScenarioClient;
  goal.seq = 3;
  goal.num_joints = 7;
  goal.kind = compliance_goal_t::GOAL_OFFSET;
  const std::vector<TimedMessage> timeline{
      {200'000'000, hold}, {200'000'000, push_t{}}, {200'000'000, goal}};
  Rig rig(limber::testing::random_arm(7, 5, true));
  rig.controller.set_timeline(&timeline);
  int seen = 0;
  for (int i = 0; i < 300; ++i) {
    rig.step();
    const auto outcomes = rig.controller.timeline_outcomes();
    if (outcomes.empty()) continue;
    seen += static_cast<int>(outcomes.size());
    ASSERT_EQ(outcomes.size(), 2U);
    EXPECT_EQ(rig.controller.status().time_ns, 200'000'000);
    EXPECT_EQ(outcomes[0].refusal, nullptr);
    const request_answer_t answer = answer_to(outcomes[1], 5);
    EXPECT_EQ(answer.time_ns, 5);
    EXPECT_EQ(answer.client, kScenarioClient);
    EXPECT_EQ(answer.seq, 3);
    EXPECT_EQ(answer.kind, +Refused::KIND_GOAL);
    EXPECT_EQ(answer.what, +compliance_goal_t::GOAL_OFFSET);
    EXPECT_EQ(answer.accepted, 0);
    EXPECT_EQ(answer.code, +Refused::REFUSED_MODE);
    EXPECT_EQ(answer.reason, "goals are accepted in ACTIVE only");
  }
  EXPECT_EQ(seen, 2) << "each is told once";
}

}  // namespace
}  // namespace limber::test_refusal_codes
