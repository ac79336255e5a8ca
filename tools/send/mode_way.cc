#include "tools/send/mode_way.h"

#include <array>
#include <limber/mode_request_t.hpp>
#include <utility>
#include <vector>

#include "controller/modes/mode_table.h"
#include "lcmtypes/mode_words.h"

namespace limber {
namespace {

using controller::Event;
using controller::Mode;

struct Request {
  std::int8_t number;
  Event event;
  const char* word() const { return kModeRequestWords[static_cast<std::size_t>(number)]; }
};

constexpr std::array<Request, 4> kRequests{{
    {mode_request_t::REQUEST_IDLE, Event::kRequestIdle},
    {mode_request_t::REQUEST_HOLD, Event::kRequestHold},
    {mode_request_t::REQUEST_ACTIVE, Event::kRequestActive},
    {mode_request_t::REQUEST_ACKNOWLEDGE, Event::kRequestAcknowledge},
}};

// The fewest requests whose last is `wanted`; empty if none leads there.
std::string way_to(const Request& wanted, Mode mode) {
  std::vector<std::pair<Mode, std::string>> ways{{mode, ""}};
  std::array<bool, controller::kModes> seen{};
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const auto [from, way] = ways[i];
    if (std::exchange(seen[static_cast<std::size_t>(from)], true)) continue;
    for (const Request& request : kRequests) {
      const controller::Transition* step = controller::find_transition(from, request.event);
      if (step == nullptr || step->to == from) continue;
      const std::string longer = (way.empty() ? "" : way + ", ") + request.word();
      if (request.number == wanted.number) return longer;
      ways.emplace_back(step->to == Mode::kSoftStop ? Mode::kHold : step->to, longer);
    }
  }
  return "";
}

}  // namespace

std::string not_in_mode(std::int8_t mode, const request_answer_t& answer) {
  // A goal or gains need a law that runs.
  const bool of_mode = answer.kind == request_answer_t::KIND_MODE;
  const int number = of_mode ? answer.what : mode_request_t::REQUEST_ACTIVE;
  const Request* wanted = nullptr;
  for (const Request& request : kRequests)
    if (request.number == number) wanted = &request;
  if (wanted == nullptr || mode < 0 || mode >= controller::kModes) return answer.reason;
  const std::string word = of_mode ? wanted->word() : "goal";
  const std::string refused =
      word + " is not taken in " + controller::kModeNames[static_cast<std::size_t>(mode)];
  switch (const Mode now{mode}; now) {
    case Mode::kBoot:
    case Mode::kInit:
      return refused + ": the controller waits for good states of the arm";
    case Mode::kSoftStop:
      return refused + ": the arm comes to rest and is then in HOLD";
    default:
      const std::string way = way_to(*wanted, now);
      if (way.empty()) return refused + ": nothing to do";
      if (way == word) return refused + " yet: the drives are not on";
      return refused + "; the way there: " + way;
  }
}

}  // namespace limber
