#include "tools/can/dbc.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace limber::bus_tools::dbc {
namespace {

constexpr const char* kHost = "limber";
constexpr std::uint32_t kExtendedFlag = 0x80000000;

/// Values of the attribute that Vector's tools know frames by.
constexpr const char* kFrameFormats[] = {"StandardCAN", "ExtendedCAN", "StandardCAN_FD",
                                         "ExtendedCAN_FD"};
constexpr int kReserved = 12;  // between the second and the third

std::uint32_t dbc_id(const Message& message) {
  return message.id | (message.extended ? kExtendedFlag : 0U);
}

int frame_format(const Message& message) {
  return (message.extended ? 1 : 0) + (message.fd ? 2 + kReserved : 0);
}

std::string quoted(std::string text) {
  std::ranges::replace(text, '"', '\'');
  return '"' + text + '"';
}

std::string signal_line(const Signal& signal, const std::string& receiver) {
  return fmt::format(" SG_ {} : {}|{}@{}{} ({},{}) [{}|{}] {} {}\n", signal.name, signal.start_bit,
                     signal.bits, signal.motorola ? 0 : 1,
                     signal.is_signed || signal.is_float ? '-' : '+', signal.scale, signal.offset,
                     signal.low, signal.high, quoted(signal.unit), receiver);
}

std::string message_text(const Message& message) {
  const std::string& sender = message.from_host ? kHost : message.node;
  const std::string receiver = message.from_host ? message.node : kHost;
  std::string text =
      fmt::format("BO_ {} {}: {} {}\n", dbc_id(message), message.name, message.bytes, sender);
  for (const Signal& signal : message.signals) text += signal_line(signal, receiver);
  return text + "\n";
}

std::string words_text(std::uint32_t id, const Signal& signal) {
  if (signal.words.empty()) return "";
  std::string text = fmt::format("VAL_ {} {}", id, signal.name);
  for (const auto& [number, word] : signal.words)
    text += fmt::format(" {} {}", number, quoted(word));
  return text + " ;\n";
}

std::string node_names(const std::vector<Message>& messages) {
  std::vector<std::string> names = {kHost};
  for (const Message& message : messages) {
    if (std::ranges::find(names, message.node) == names.end()) names.push_back(message.node);
  }
  return fmt::format("BU_: {}\n\n", fmt::join(names, " "));
}

std::string format_attribute() {
  std::vector<std::string> words;
  for (int i = 0; i < 4; ++i) {
    if (i == 2) words.insert(words.end(), kReserved, "\"reserved\"");
    words.push_back(quoted(kFrameFormats[i]));
  }
  return fmt::format(
      "BA_DEF_ BO_ \"VFrameFormat\" ENUM {};\nBA_DEF_DEF_ \"VFrameFormat\" \"StandardCAN\";\n",
      fmt::join(words, ","));
}

}  // namespace

std::string identifier(const std::string& name) {
  std::string out;
  for (const char c : name) out += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  if (out.empty() || std::isdigit(static_cast<unsigned char>(out.front())) != 0) out = "_" + out;
  return out;
}

std::string file_text(const std::string& comment, const std::vector<Message>& messages) {
  std::string text = "VERSION \"\"\n\nNS_ :\n\nBS_:\n\n" + node_names(messages);
  for (const Message& message : messages) text += message_text(message);
  text += fmt::format("CM_ {};\n", quoted(comment));
  for (const Message& message : messages) {
    if (!message.comment.empty())
      text += fmt::format("CM_ BO_ {} {};\n", dbc_id(message), quoted(message.comment));
  }
  text += format_attribute();
  for (const Message& message : messages)
    text +=
        fmt::format("BA_ \"VFrameFormat\" BO_ {} {};\n", dbc_id(message), frame_format(message));
  for (const Message& message : messages) {
    for (const Signal& signal : message.signals) text += words_text(dbc_id(message), signal);
  }
  for (const Message& message : messages) {
    for (const Signal& signal : message.signals) {
      if (signal.is_float)
        text += fmt::format("SIG_VALTYPE_ {} {} : 1;\n", dbc_id(message), signal.name);
    }
  }
  return text;
}

}  // namespace limber::bus_tools::dbc
