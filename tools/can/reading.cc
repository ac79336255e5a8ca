#include "tools/can/reading.h"

#include <fmt/format.h>

namespace limber::bus_tools {

const char* word_of(Direction direction) {
  switch (direction) {
    case Direction::kCommand:
      return "command";
    case Direction::kReply:
      return "reply";
    case Direction::kError:
      return "error";
    case Direction::kForeign:
      break;
  }
  return "foreign";
}

std::string number(double value) { return fmt::format("{:.5g}", value); }

std::string hex(std::uint32_t value, int digits) { return fmt::format("{:0{}X}", value, digits); }

std::string bytes(const CanFrame& frame) {
  if (frame.remote) return "remote";
  std::string text;
  for (std::size_t i = 0; i < frame.length; ++i)
    text += fmt::format("{}{:02X}", i == 0 ? "" : " ", frame.data[i]);
  return text;
}

std::string text_of(const std::vector<Value>& values) {
  std::string text;
  for (const Value& value : values) {
    std::string one = value.name;
    for (const std::string& part : {value.text, value.unit})
      one += (one.empty() || part.empty() ? "" : " ") + part;
    text += (text.empty() ? "" : ", ") + one;
  }
  return text;
}

}  // namespace limber::bus_tools
