// What became of a request, without the text and memory of a REQUEST_ANSWER.
#pragma once

#include <limber/compliance_gains_t.hpp>
#include <limber/compliance_goal_t.hpp>
#include <limber/hand_goal_t.hpp>
#include <limber/mode_request_t.hpp>
#include <limber/target_stream_t.hpp>
#include <limber/torque_overlay_t.hpp>

#include "controller/kinds/refusal.h"

namespace limber {

/// See request_answer_t. May be made in the cycle.
struct RequestOutcome {
  std::int8_t kind = request_answer_t::KIND_MODE;
  std::int8_t what = 0;
  std::int64_t client = 0;
  std::int64_t seq = 0;
  Refusal refusal;
};

inline RequestOutcome outcome_of(const mode_request_t& mode, Refusal refusal) noexcept {
  return {request_answer_t::KIND_MODE, mode.request, mode.client, mode.seq, refusal};
}
inline RequestOutcome outcome_of(const compliance_goal_t& goal, Refusal refusal) noexcept {
  return {request_answer_t::KIND_GOAL, goal.kind, goal.client, goal.seq, refusal};
}
inline RequestOutcome outcome_of(const target_stream_t& stream, Refusal refusal) noexcept {
  return {request_answer_t::KIND_STREAM, stream.kind, stream.client, stream.seq, refusal};
}
inline RequestOutcome outcome_of(const torque_overlay_t& overlay, Refusal refusal) noexcept {
  return {request_answer_t::KIND_OVERLAY, 0, overlay.client, overlay.seq, refusal};
}
inline RequestOutcome outcome_of(const compliance_gains_t& gains, Refusal refusal) noexcept {
  return {request_answer_t::KIND_GAINS, 0, gains.client, gains.seq, refusal};
}
inline RequestOutcome outcome_of(const hand_goal_t& hand, Refusal refusal) noexcept {
  return {request_answer_t::KIND_HAND, 0, hand.client, hand.seq, refusal};
}

}  // namespace limber
