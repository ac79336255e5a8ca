// Strict reading of YAML: every access gives type and allowed range, every error names file,
// line, key and value, and a key that no access used is an error.
#pragma once

#include <yaml-cpp/yaml.h>

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
  /// Reads a whole file. Refuses: unreadable, larger than 1 MiB, not one mapping, duplicate keys,
  /// aliases, anchors, tags, nesting deeper than 12.
  static YamlMap from_file(const std::string& path);
  /// The same from text; `name` stands for the file in messages.
  static YamlMap from_text(const std::string& text, const std::string& name);

  /// This mapping with another merged onto it: mappings are merged key by key, everything else
  /// replaces what is there. Messages name both files and the line of whichever the value is from.
  YamlMap merged_with(const YamlMap& other) const;

  /// Whether the key is there; marks it as known.
  bool has(const std::string& key) const;
  /// Whether the key's value is a list (or a mapping); marks it as known.
  bool is_list(const std::string& key) const;
  bool is_map(const std::string& key) const;

  /// A finite number within the range. "1,5", "nan", "inf", "12kg" and quoted text are refused.
  double number(const std::string& key, Range allowed) const;
  double number_or(const std::string& key, Range allowed, double otherwise) const;
  /// Decimal, or hexadecimal as 0x1F.
  long integer(const std::string& key, long low, long high) const;
  long integer_or(const std::string& key, long low, long high, long otherwise) const;
  bool boolean_or(const std::string& key, bool otherwise) const;
  /// Text that is not empty.
  std::string text(const std::string& key) const;
  /// Text that is fit for a name, see common/names.h.
  std::string name(const std::string& key) const;
  std::string text_or(const std::string& key, const std::string& otherwise) const;
  /// One of the words; the message lists them.
  std::string word(const std::string& key, const std::vector<std::string>& allowed) const;
  std::string word_or(const std::string& key, const std::vector<std::string>& allowed,
                      const std::string& otherwise) const;
  /// A sequence of numbers. `size` -1: any length. A single number is repeated `size` times where
  /// `broadcast` is set.
  std::vector<double> numbers(const std::string& key, int size, Range allowed,
                              bool broadcast = false) const;
  /// A sequence of `rows` sequences of `columns` numbers, row by row.
  std::vector<double> matrix(const std::string& key, int rows, int columns, Range allowed) const;

  YamlMap map(const std::string& key) const;
  /// A sequence of mappings.
  std::vector<YamlMap> maps(const std::string& key) const;
  /// The keys of this mapping in file order (for maps from names to things); marks them as known.
  std::vector<std::string> keys() const;

  /// Refuses these keys where they are: they belong to another `choice`, as "fd: true".
  void leave_to(const std::string& choice, const std::vector<std::string>& keys) const;
  /// "file:line: path: what", for a note about this mapping's key.
  std::string note(const std::string& key, const std::string& what) const;

  /// Refuses keys that were never read: "unknown key 'x'; allowed here: ...".
  void finish() const;

  /// A complaint about this mapping's key, for checks that need more than a range.
  [[noreturn]] void refuse(const std::string& key, const std::string& problem) const;
  /// A complaint about this mapping as a whole.
  [[noreturn]] void refuse(const std::string& problem) const;
  /// "'key' is missing: what", with the key that looks like a slip for it.
  [[noreturn]] void refuse_missing(const std::string& key, const std::string& what) const;
  /// Line of the key, or of this mapping if the key is not there.
  int line_of(const std::string& key) const;
  int line() const;
  const std::string& file() const { return *file_; }

 private:
  YamlMap(const YAML::Node& node, std::string path, std::shared_ptr<const std::string> file);
  YAML::Node find(const std::string& key) const;
  YAML::Node need(const std::string& key, const std::string& what) const;
  std::string path_to(const std::string& key) const;
  double to_number(const std::string& key, const YAML::Node& node, Range allowed) const;
  [[noreturn]] void complain(const YAML::Node& node, const std::string& key,
                             const std::string& problem) const;

  YAML::Node node_;
  std::string path_;
  std::shared_ptr<const std::string> file_;
  std::shared_ptr<std::vector<std::string>> known_;
};

}  // namespace limber
