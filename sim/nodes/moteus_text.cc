#include "sim/nodes/moteus_text.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace limber::sim {

void MoteusText::take(std::string_view text) noexcept {
  std::memmove(in_.data(), in_.data() + line_size_, in_size_ - line_size_);
  in_size_ -= line_size_;
  line_size_ = 0;
  if (text.size() > in_.size() - in_size_) {
    in_size_ = 0;  // a line that never ends must not block those after it
    return;
  }
  std::copy(text.begin(), text.end(), in_.begin() + static_cast<std::ptrdiff_t>(in_size_));
  in_size_ += text.size();
}

bool MoteusText::line(std::string_view* line) noexcept {
  const std::string_view rest(in_.data() + line_size_, in_size_ - line_size_);
  const std::size_t end = rest.find_first_of("\r\n");
  if (end == std::string_view::npos) return false;
  *line = rest.substr(0, end);
  line_size_ += end + 1;
  return true;
}

void MoteusText::write(std::string_view text) noexcept {
  if (read_ == written_) read_ = written_ = 0;
  const std::size_t taken = std::min(text.size(), out_.size() - written_);
  std::copy_n(text.begin(), taken, out_.begin() + static_cast<std::ptrdiff_t>(written_));
  written_ += taken;
}

void MoteusText::write_value(std::string_view before, double value, bool whole,
                             std::string_view after) noexcept {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), whole ? "%.0f" : "%f", value);
  write(before);
  write(text.data());
  write(after);
}

void MoteusText::error(std::string_view why) noexcept {
  write("ERR ");
  write(why);
  write("\r\n");
}

std::string_view MoteusText::read(std::size_t most) noexcept {
  const std::string_view bytes(out_.data() + read_, std::min(most, written_ - read_));
  read_ += bytes.size();
  return bytes;
}

std::string_view next_word(std::string_view* text) noexcept {
  const std::size_t first = std::min(text->find_first_not_of(' '), text->size());
  text->remove_prefix(first);
  const std::string_view word = text->substr(0, text->find(' '));
  text->remove_prefix(word.size());
  text->remove_prefix(std::min(text->find_first_not_of(' '), text->size()));
  return word;
}

bool parse_number(std::string_view word, double* value) noexcept {
  std::array<char, 32> text{};
  if (word.empty() || word.size() >= text.size()) return false;
  std::copy(word.begin(), word.end(), text.begin());
  char* end = nullptr;
  *value = std::strtod(text.data(), &end);
  return end == text.data() + word.size();
}

}  // namespace limber::sim
