#include "common/complaints.h"

namespace limber {

void Complaints::add(int line, const std::string& where, const std::string& problem) {
  add(ConfigError::at(file_, line, where, problem).what());
}

void Complaints::add(const std::string& complaint) {
  constexpr std::size_t kMost = 50;
  if (lines_.size() > kMost) return;
  lines_.push_back(lines_.size() < kMost ? complaint : file_ + ": and more");
}

void Complaints::throw_if_any() const {
  if (lines_.empty()) return;
  std::string text;
  for (const std::string& line : lines_) text += (text.empty() ? "" : "\n") + line;
  throw ConfigError(text);
}

}  // namespace limber
