#include "drivers/can/candump_log.h"

#include <fmt/format.h>

#include <charconv>
#include <stdexcept>

#include "common/config_error.h"

namespace limber {
namespace {

constexpr std::uint32_t kErrorFlag = 0x20000000;
constexpr unsigned kBitRateSwitch = 1;
constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::int64_t kLatestSecond = INT64_MAX / kSecond_ns - 1;  // in the year 2262

/// Takes text from the front of a line; every member is false if it is not there.
class LineReader {
 public:
  explicit LineReader(std::string_view line) : left_(line) {}

  bool character(char wanted) {
    if (left_.empty() || left_.front() != wanted) return false;
    left_.remove_prefix(1);
    return true;
  }
  bool blanks() {
    const bool some = !left_.empty() && is_blank(left_.front());
    while (!left_.empty() && is_blank(left_.front())) left_.remove_prefix(1);
    return some;
  }
  std::string_view word(std::string_view ends) {
    const std::size_t size = std::min(left_.find_first_of(ends), left_.size());
    const std::string_view found = left_.substr(0, size);
    left_.remove_prefix(size);
    return found;
  }
  bool at_end() const { return left_.empty(); }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
  std::string_view left_;
};

template <typename Number>
bool whole_number(std::string_view text, int base, Number* value) {
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), *value, base);
  return error == std::errc() && stop == text.data() + text.size();
}

/// "1436509052.249713", with up to nine digits behind the point.
bool read_time(std::string_view text, std::int64_t* time_ns) {
  const std::size_t point = text.find('.');
  std::int64_t seconds = 0;
  if (!whole_number(text.substr(0, point), 10, &seconds) || seconds < 0 || seconds > kLatestSecond)
    return false;
  *time_ns = seconds * kSecond_ns;
  if (point == std::string_view::npos) return true;
  std::string digits(text.substr(point + 1));
  if (digits.empty() || digits.size() > 9) return false;
  digits.resize(9, '0');
  std::uint32_t fraction = 0;
  if (!whole_number(digits, 10, &fraction)) return false;
  *time_ns += fraction;
  return true;
}

bool read_id(std::string_view text, CanFrame* frame) {
  std::uint32_t id = 0;
  if ((text.size() != 3 && text.size() != 8) || !whole_number(text, 16, &id)) return false;
  frame->error = text.size() == 8 && (id & kErrorFlag) != 0;
  frame->extended = text.size() == 8 && !frame->error;
  frame->id = frame->error ? id & ~kErrorFlag : id;
  return true;
}

/// Pairs of digits, with points between them or not.
bool read_data(std::string_view text, CanFrame* frame) {
  frame->length = 0;
  while (!text.empty()) {
    if (text.front() == '.') {
      text.remove_prefix(1);
      continue;
    }
    std::uint8_t byte = 0;
    if (text.size() < 2 || frame->length == frame->data.size() ||
        !whole_number(text.substr(0, 2), 16, &byte))
      return false;
    frame->data[frame->length++] = byte;
    text.remove_prefix(2);
  }
  return true;
}

bool read_classic(std::string_view text, CanFrame* frame) {
  text = text.substr(0, text.find('_'));  // a raw DLC above 8 tells no more
  frame->remote = !text.empty() && text.front() == 'R';
  if (!frame->remote) return read_data(text, frame);
  text.remove_prefix(1);
  return text.empty() || whole_number(text, 10, &frame->length);
}

bool read_fd(std::string_view text, CanFrame* frame) {
  unsigned flags = 0;
  if (text.empty() || !whole_number(text.substr(0, 1), 16, &flags)) return false;
  frame->fd = true;
  frame->bitrate_switch = (flags & kBitRateSwitch) != 0;
  return read_data(text.substr(1), frame);
}

}  // namespace

std::string to_candump(const LoggedFrame& logged) {
  const CanFrame& frame = logged.frame;
  const std::int64_t time_us = logged.time_ns / 1000;
  std::string line =
      fmt::format("({}.{:06}) {} ", time_us / 1'000'000, time_us % 1'000'000, logged.interface);
  line += frame.error      ? fmt::format("{:08X}#", frame.id | kErrorFlag)
          : frame.extended ? fmt::format("{:08X}#", frame.id)
                           : fmt::format("{:03X}#", frame.id);
  if (frame.fd) line += fmt::format("#{:X}", frame.bitrate_switch ? kBitRateSwitch : 0U);
  if (frame.remote) return line + (frame.length > 0 ? fmt::format("R{}", frame.length) : "R");
  for (std::size_t i = 0; i < frame.length; ++i) line += fmt::format("{:02X}", frame.data[i]);
  return line;
}

bool from_candump(std::string_view line, LoggedFrame* logged) {
  *logged = {};
  LineReader reader(line);
  reader.blanks();
  if (!reader.character('(') || !read_time(reader.word(")"), &logged->time_ns)) return false;
  if (!reader.character(')') || !reader.blanks()) return false;
  logged->interface = reader.word(" \t");
  CanFrame& frame = logged->frame;
  if (logged->interface.empty() || !reader.blanks() || !read_id(reader.word("#"), &frame) ||
      !reader.character('#'))
    return false;
  const bool fd = reader.character('#');
  const std::string_view data = reader.word(" \t\r");
  if (!(fd ? read_fd(data, &frame) : read_classic(data, &frame))) return false;
  reader.blanks();
  if (!reader.character('T')) static_cast<void>(reader.character('R'));
  reader.blanks();
  frame.timestamp_ns = logged->time_ns;
  return reader.at_end() && is_possible(frame);
}

std::string candump_interface(const std::string& address) {
  const std::size_t colon = address.find(':');
  return colon == std::string::npos ? address : address.substr(colon + 1);
}

CandumpWriter::CandumpWriter(const std::string& path) : path_(path), file_(path) {
  if (!file_) throw ConfigError::at(path, 0, "", "cannot be written");
}

void CandumpWriter::write(const LoggedFrame& logged) {
  file_ << to_candump(logged) << '\n';
  check();
  ++frames_;
}

void CandumpWriter::flush() {
  file_.flush();
  check();
}

void CandumpWriter::check() const {
  if (!file_) throw std::runtime_error(path_ + ": write failed; is the disk full?");
}

CandumpReader::CandumpReader(const std::string& path) : path_(path), file_(path) {
  if (!file_) throw ConfigError::at(path, 0, "", "cannot be read");
}

bool CandumpReader::next(LoggedFrame* logged) {
  std::string text;
  while (std::getline(file_, text)) {
    ++line_;
    if (text.find_first_not_of(" \t\r") == std::string::npos) continue;
    if (from_candump(text, logged)) return true;
    throw ConfigError::at(path_, line_, "",
                          "no line of a candump log: expected (SECONDS) INTERFACE ID#DATA, or "
                          "ID##FLAGSDATA for FD, as candump -l writes it");
  }
  return false;
}

}  // namespace limber
