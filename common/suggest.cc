#include "common/suggest.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <numeric>
#include <string_view>

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

bool is_unit(std::string_view suffix) {
  constexpr std::array<std::string_view, 20> kParts = {
      "N",  "m",    "s",  "rad", "Nm", "Nms", "Ns", "kg", "kgm2", "per",
      "m2", "rad2", "s2", "A",   "V",  "W",   "J",  "Hz", "ohm",  "degC"};
  while (!suffix.empty()) {
    const std::string_view part = suffix.substr(0, suffix.find('_'));
    if (std::ranges::find(kParts, part) == kParts.end()) return false;
    suffix.remove_prefix(std::min(part.size() + 1, suffix.size()));
  }
  return true;
}

/// home and home_rad: the word lacks the unit that the candidate ends in.
bool lacks_unit(std::string_view word, std::string_view candidate) {
  return candidate.size() > word.size() + 1 && candidate.starts_with(word) &&
         candidate[word.size()] == '_' && is_unit(candidate.substr(word.size() + 1));
}

/// Common words, and the beginnings of those that limber has for them.
struct Common {
  std::string_view word;
  std::array<std::string_view, 4> here;
};
constexpr std::array<Common, 7> kCommon = {{
    {"stiffness", {"K_x_translation_", "K_x_rotation_", "K_q_", "gains"}},
    {"spring", {"K_x_translation_", "K_x_rotation_", "K_q_", "transmission"}},
    {"compliance", {"K_x_translation_", "K_x_rotation_", "K_q_", "gains"}},
    {"impedance", {"law", "gains"}},
    {"admittance", {"law", "gains"}},
    {"controller", {"law", "gains"}},
    {"speed", {"velocity_", "velocity_limit_"}},
}};

/// Words that begin as people's word lets expect, or that have it as one of their parts.
std::vector<std::string> meant_by(std::string word, const std::vector<std::string>& known) {
  constexpr std::size_t kMost = 3;
  std::ranges::transform(word, word.begin(), [](unsigned char c) { return std::tolower(c); });
  std::vector<std::string> meant;
  for (const Common& common : kCommon) {
    if (word.find(common.word) == std::string::npos) continue;
    for (const std::string_view beginning : common.here) {
      const auto found = std::ranges::find_if(known, [&](const std::string& one) {
        return !beginning.empty() && one.starts_with(beginning);
      });
      if (found != known.end() && std::ranges::find(meant, *found) == meant.end())
        meant.push_back(*found);
    }
  }
  for (const std::string& one : known) {
    if (word.size() > 3 && ("_" + one + "_").find("_" + word + "_") != std::string::npos)
      meant.push_back(one);
  }
  if (meant.size() > kMost) meant.resize(kMost);
  return meant;
}

}  // namespace

std::string nearest_word(const std::string& word, const std::vector<std::string>& known) {
  constexpr std::size_t kLongestWord = 64;
  constexpr std::size_t kShortestPart = 3;
  if (word.size() > kLongestWord) return "";
  const auto find = [&](auto fits) {
    const auto found = std::ranges::find_if(known, fits);
    return found == known.end() ? std::string() : *found;
  };
  const std::string with_unit = find([&](const auto& one) { return lacks_unit(word, one); });
  if (!with_unit.empty()) return with_unit;
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
  const std::string beginning = find([&](const std::string& one) {
    return one.size() >= kShortestPart && word.starts_with(one + "_");
  });
  if (!beginning.empty()) return beginning;
  // cartesian and cartesian_impedance: a whole part of one candidate alone
  const auto holds = [&](const std::string& one) {
    return word.size() > kShortestPart &&
           ("_" + one + "_").find("_" + word + "_") != std::string::npos;
  };
  return std::ranges::count_if(known, holds) == 1 ? find(holds) : "";
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& known) {
  std::vector<std::string> meant;
  if (const std::string near = nearest_word(word, known); !near.empty()) meant = {near};
  if (meant.empty()) meant = meant_by(word, known);
  std::string text;
  for (const std::string& one : meant) text += (text.empty() ? "'" : " or '") + one + "'";
  return text.empty() ? "" : "did you mean " + text + "?";
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

}  // namespace limber
