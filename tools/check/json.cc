#include "tools/check/json.h"

#include <fmt/format.h>

#include <cmath>

namespace limber::json {

std::string text(const std::string& value) {
  std::string quoted = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') {
      quoted += std::string("\\") + c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      quoted += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

std::string flag(bool value) { return value ? "true" : "false"; }

std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "null";
}

std::string list(const std::vector<std::string>& values) {
  std::string joined;
  for (const std::string& value : values) joined += (joined.empty() ? "" : ", ") + value;
  return "[" + joined + "]";
}

std::string numbers(const std::vector<double>& values) {
  std::vector<std::string> written;
  written.reserve(values.size());
  for (const double value : values) written.push_back(number(value));
  return list(written);
}

std::string texts(const std::vector<std::string>& values) {
  std::vector<std::string> written;
  written.reserve(values.size());
  for (const std::string& value : values) written.push_back(text(value));
  return list(written);
}

std::string object(const Members& members) {
  std::string joined;
  for (const auto& [key, value] : members)
    joined += (joined.empty() ? "" : ", ") + text(key) + ": " + value;
  return "{" + joined + "}";
}

}  // namespace limber::json
