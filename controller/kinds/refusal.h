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

}  // namespace limber
