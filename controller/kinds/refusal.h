// Why a request is refused: a kind that users can look up, and the reason with its numbers.
#pragma once

#include <cstdint>
#include <limber/request_answer_t.hpp>

namespace limber {

/// Stands for the reason alone where a pointer is wanted: nullptr if the request was taken. The
/// reason lasts as long as who gave it. May be used in the cycle.
struct Refusal {
  std::int8_t code = request_answer_t::REFUSED_NOTHING;  ///< in words: lcmtypes/problems.yaml
  const char* reason = nullptr;
  const char* warning = nullptr;  ///< of a request that was taken all the same

  constexpr operator const char*() const noexcept { return reason; }
};

/// The message itself is wrong: a number that is not finite, of another arm, of no kind.
constexpr Refusal malformed(const char* reason) noexcept {
  return {request_answer_t::REFUSED_MALFORMED, reason};
}
/// A number of a goal is outside what a goal may be.
constexpr Refusal beyond_goal_limit(const char* reason) noexcept {
  return {request_answer_t::REFUSED_GOAL_LIMIT, reason};
}

}  // namespace limber
