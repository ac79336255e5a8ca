#include "drivers/drives_text.h"

#include <array>

#include "common/problem_text.h"

namespace limber {
namespace {

constexpr std::array kDrives = {"configuring", "off",  "enabling", "on",
                                "fallback",    "damp", "fault"};

std::string drives_in(int state) {
  const auto index = static_cast<std::size_t>(state);
  return std::string("drives: ") + (index < kDrives.size() ? kDrives[index] : "unknown");
}

}  // namespace

std::string drives_text(int state, int fault, const std::string& joint, const std::string& detail) {
  if (fault == joint_state_t::FAULT_NONE) return drives_in(state);
  const std::string text =
      drives_in(state) + ": " + problem_text(problems::kDriver, fault, joint, detail);
  return fault == joint_state_t::FAULT_REQUESTED ? text : "warning: " + text;
}

std::string drives_text_again(int state, int fault) {
  const Problem* problem = find_problem(problems::kDriver, fault);
  return problem == nullptr ? drives_in(state) : drives_in(state) + "; still " + problem->code;
}

}  // namespace limber
