// A request that does not fit the controller's mode, in words.
#pragma once

#include <limber/request_answer_t.hpp>
#include <string>

namespace limber {

/// Why the request of an answer with REFUSED_MODE is not taken in a mode (controller_status_t), and
/// the requests that lead there: "active is not taken in FAULT; the way there: acknowledge, hold,
/// active". The same words as in Python's limber.live.way.
std::string not_in_mode(std::int8_t mode, const request_answer_t& answer);

}  // namespace limber
