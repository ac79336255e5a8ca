// Strict reading of YAML: every access says type and allowed range, every complaint names file,
// line, key and value, and a key nobody asked for is an error.
#pragma once

#include <yaml-cpp/yaml.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace limber {

struct Range {
  double low;
  double high;
};

/// One mapping of a YAML file. Reading a key marks it as known; finish() refuses whatever is left.
/// All members throw ConfigError (file:line: path.key: what was found; what is allowed). Set-up
/// only.
class YamlMap {
 public:
  /// Reads a whole file. Refuses: unreadable, larger than 1 MiB, not a mapping, duplicate keys,
  /// aliases and anchors.
  static YamlMap from_file(const std::string& path);
  /// The same from text; `name` stands for the file in messages.
  static YamlMap from_text(const std::string& text, const std::string& name);

  bool has(const std::string& key) const;

  /// A finite number within the range. "1,5", "nan", "inf", "12kg" and quoted text are refused.
  double number(const std::string& key, Range allowed);
  double number_or(const std::string& key, Range allowed, double otherwise);
  long integer(const std::string& key, long low, long high);
  long integer_or(const std::string& key, long low, long high, long otherwise);
  bool boolean_or(const std::string& key, bool otherwise);
  std::string text(const std::string& key);
  std::string text_or(const std::string& key, const std::string& otherwise);
  /// One of the words; the message lists them.
  std::string word(const std::string& key, const std::vector<std::string>& allowed);
  std::string word_or(const std::string& key, const std::vector<std::string>& allowed,
                      const std::string& otherwise);
  /// A sequence of numbers. `size` -1: any length. A single number is repeated `size` times where
  /// `broadcast` is set.
  std::vector<double> numbers(const std::string& key, int size, Range allowed,
                              bool broadcast = false);
  std::vector<std::string> texts(const std::string& key);

  YamlMap map(const std::string& key);
  /// A sequence of mappings.
  std::vector<YamlMap> maps(const std::string& key);
  /// The keys of this mapping in file order (for maps from names to things); marks them as known.
  std::vector<std::string> keys();

  /// Refuses keys that were never asked for: "unknown key 'x'; allowed here: ...".
  void finish() const;

  /// A complaint about this mapping's key, for checks that need more than a range.
  [[noreturn]] void refuse(const std::string& key, const std::string& problem) const;
  int line_of(const std::string& key) const;
  const std::string& file() const;

 private:
  struct Shared;
  YamlMap(YAML::Node node, std::string path, std::shared_ptr<const std::string> file);

  YAML::Node node_;
  std::string path_;
  std::shared_ptr<const std::string> file_;
  std::shared_ptr<std::vector<std::string>> known_;
};

}  // namespace limber
