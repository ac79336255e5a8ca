// A supervisor of one joint, fed state by state, and the requests of two clients.
#pragma once

#include <gtest/gtest.h>

#include <limber/joint_command_t.hpp>
#include <string>

#include "controller/modes/supervisor.h"

namespace limber::controller::supervisor_bench {

using Request = mode_request_t;
using Command = joint_command_t;
using State = joint_state_t;
using Reasons = controller_status_t;

inline constexpr std::int64_t kPeriod_ns = 1'000'000;
inline constexpr std::int64_t kMine = 1;
inline constexpr std::int64_t kOther = 2;

class SupervisorBench : public ::testing::Test {
 protected:
  joint_state_t state(std::int8_t drive_state) {
    joint_state_t made{};
    made.seq = ++seq_;
    made.session = session_;
    made.time_ns = seq_ * kPeriod_ns + late_ns_;
    made.period_ns = kPeriod_ns;
    made.num_joints = 1;
    made.drive_state = drive_state;
    made.joint_flags[0] = State::JOINT_FRESH;
    return made;
  }
  void states(std::int64_t count, std::int8_t drive_state) {
    for (std::int64_t i = 0; i < count; ++i) supervisor_.on_state(state(drive_state));
  }
  static Request made(std::int8_t what, std::int64_t client = kMine) {
    Request request{};
    request.client = client;
    request.request = what;
    return request;
  }
  /// "" if it was obeyed.
  std::string ask(std::int8_t what, std::int64_t client = kMine) {
    const Refusal refusal = supervisor_.on_mode(made(what, client));
    const std::string reason = refusal ? refusal.reason : "";
    EXPECT_EQ(int{refusal.code}, kind_of(reason)) << reason;
    return reason;
  }
  /// Of the kinds of refusal: who asks, what for, and when.
  static int kind_of(const std::string& reason) {
    using Answer = request_answer_t;
    if (reason.empty()) return Answer::REFUSED_NOTHING;
    if (reason.starts_with("the request is none")) return Answer::REFUSED_MALFORMED;
    if (reason.starts_with("client")) return Answer::REFUSED_CLIENT;
    if (reason.starts_with("the springs")) return Answer::REFUSED_PRELOAD;
    if (reason.find("lease") != std::string::npos) return Answer::REFUSED_LEASE;
    const bool cause = reason.starts_with("the cause") || reason.starts_with("the emergency stop");
    return cause ? Answer::REFUSED_CAUSE_REMAINS : Answer::REFUSED_MODE;
  }
  void to_hold() {
    states(Supervisor::kSteadyStates, State::DRIVE_OFF);
    ASSERT_EQ(ask(Request::REQUEST_HOLD), "");
    states(1, State::DRIVE_ON);
    ASSERT_TRUE(supervisor_.engaged());
  }
  int drive_request() const { return supervisor_.drive_request(); }

  Supervisor supervisor_{1, 2};
  std::int64_t seq_ = -1;
  std::int64_t session_ = 5;
  std::int64_t late_ns_ = 0;
};

}  // namespace limber::controller::supervisor_bench
