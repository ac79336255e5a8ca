// One idea of what a number in a file is, for YAML and XML alike.
#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

namespace limber {

/// The finite decimal number that makes up the whole of `text`; nothing for "1,5", "12kg", "nan",
/// "1e999", " 1" or "". Independent of the locale. Set-up only.
inline std::optional<double> parse_number(std::string_view text) {
  if (text.starts_with('+')) {
    text.remove_prefix(1);
    if (text.starts_with('-')) return std::nullopt;
  }
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

}  // namespace limber
