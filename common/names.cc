#include "common/names.h"

#include <fmt/format.h>

#include <algorithm>

namespace limber {
namespace {

constexpr std::size_t kLongestName = 64;
constexpr std::size_t kLongestShown = 128;

bool is_letter_or_digit(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

bool is_control(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte < 0x20 || byte == 0x7F;
}

/// The beginning, control characters replaced.
std::string quoted(std::string name) {
  constexpr std::size_t kShown = 40;
  const bool cut = name.size() > kShown;
  name.resize(std::min(name.size(), kShown));
  std::ranges::replace_if(name, is_control, '?');
  return "'" + name + (cut ? "..." : "") + "'";
}

}  // namespace

std::string name_problem(const std::string& name) {
  const bool fine =
      !name.empty() && name.size() <= kLongestName && is_letter_or_digit(name.front()) &&
      name.back() != ' ' && std::ranges::all_of(name, [](char c) {
        return is_letter_or_digit(c) || std::string_view(" _.-").find(c) != std::string_view::npos;
      });
  if (fine) return "";
  return fmt::format(
      "{} is no name; expected a letter or digit, then letters, digits, blanks, _ . "
      "or -, at most {}",
      quoted(name), kLongestName);
}

std::string shown_name_problem(const std::string& name) {
  if (name.size() <= kLongestShown && std::ranges::none_of(name, is_control)) return "";
  return fmt::format("{} is no name; expected text without control characters, at most {} bytes",
                     quoted(name), kLongestShown);
}

}  // namespace limber
