#include "common/problem_text.h"

#include <algorithm>

namespace limber {
namespace {

constexpr const char* kMore = "; see docs/troubleshooting.md";

std::string unknown(int value) { return "unknown number " + std::to_string(value); }

}  // namespace

const Problem* find_problem(std::span<const Problem> group, int value) noexcept {
  const auto found = std::ranges::find(group, value, &Problem::value);
  return found == group.end() ? nullptr : &*found;
}

std::string problem_text(std::span<const Problem> group, int value, const std::string& where,
                         const std::string& detail) {
  const Problem* problem = find_problem(group, value);
  std::string text =
      problem == nullptr ? unknown(value) : std::string(problem->code) + ": " + problem->what;
  if (!where.empty()) text += " (" + where + ")";
  if (!detail.empty()) text += ": " + detail;
  return problem == nullptr ? text : text + "; " + problem->remedy + kMore;
}

std::string refusal_text(int code, const std::string& reason) {
  const Problem* problem = find_problem(problems::kRequest, code);
  if (problem == nullptr) return unknown(code) + ": " + reason;
  return std::string(problem->code) + ": " + reason + "; " + problem->remedy + kMore;
}

}  // namespace limber
