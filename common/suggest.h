// "Did you mean": the known word nearest to a misspelt one.
#pragma once

#include <string>
#include <vector>

namespace limber {

/// The word that takes the fewest single-letter edits, if they are few enough to be a slip; else
/// the first that differs by its unit only (home, home_rad); else empty.
std::string nearest_word(const std::string& word, const std::vector<std::string>& known);

/// "did you mean 'a'?" or "did you mean 'a' or 'b'?": the nearest word, or what people mean by one
/// that limber does not use (stiffness, impedance); else empty.
std::string did_you_mean(const std::string& word, const std::vector<std::string>& known);

/// "a, b, c".
std::string joined(const std::vector<std::string>& words);

}  // namespace limber
