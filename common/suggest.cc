#include "common/suggest.h"

#include <algorithm>
#include <numeric>

namespace limber {
namespace {

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

/// home and home_rad: one lacks the unit that the other ends in.
bool lacks_unit(const std::string& word, const std::string& candidate) {
  constexpr std::size_t kShortest = 3;
  if (std::min(word.size(), candidate.size()) < kShortest) return false;
  return candidate.starts_with(word + "_") || word.starts_with(candidate + "_");
}

}  // namespace

std::string nearest_word(const std::string& word, const std::vector<std::string>& known) {
  constexpr std::size_t kLongestWord = 64;
  if (word.size() > kLongestWord) return "";
  std::string best;
  std::size_t fewest = word.size() / 3 + 1;  // more edits than this are another word
  for (const std::string& candidate : known) {
    if (candidate.size() > kLongestWord) continue;
    const std::size_t edits = edit_distance(word, candidate);
    if (edits < fewest || (edits == fewest && best.empty())) {
      fewest = edits;
      best = candidate;
    }
  }
  if (!best.empty()) return best;
  const auto longer = std::ranges::find_if(
      known, [&](const std::string& candidate) { return lacks_unit(word, candidate); });
  return longer == known.end() ? "" : *longer;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

}  // namespace limber
