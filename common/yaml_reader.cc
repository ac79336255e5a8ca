#include "common/yaml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "common/config_error.h"
#include "common/names.h"
#include "common/parse_number.h"
#include "common/suggest.h"
#include "common/unit_hint.h"
#include "common/yaml_strict.h"

namespace limber {
namespace {

constexpr std::uintmax_t kLargestFile = 1 << 20;
constexpr std::size_t kLongestQuote = 40;

bool is_plain(const YAML::Node& node) { return node.Tag() != "!"; }

/// What stands in the file, for a message.
std::string found(const YAML::Node& node) {
  if (node.IsNull()) return "nothing";
  if (node.IsMap()) return "a mapping";
  if (node.IsSequence()) return "a list";
  std::string text = node.Scalar();
  if (text.size() > kLongestQuote) text = text.substr(0, kLongestQuote) + "...";
  return is_plain(node) ? "'" + text + "'" : "the text \"" + text + "\"";
}

std::string wanted(Range allowed) {
  return fmt::format("a number from {} to {}", allowed.low, allowed.high);
}

/// Neither node is changed; what is not merged is shared.
YAML::Node merged(const YAML::Node& under, const YAML::Node& over) {
  if (!under.IsDefined() || !under.IsMap() || !over.IsMap()) return over;
  YAML::Node result(YAML::NodeType::Map);
  for (const auto& entry : under) {
    const YAML::Node replacement = over[entry.first.Scalar()];
    result[entry.first] =
        replacement.IsDefined() ? merged(entry.second, replacement) : entry.second;
  }
  for (const auto& entry : over) {
    if (!under[entry.first.Scalar()].IsDefined()) result[entry.first] = entry.second;
  }
  return result;
}

}  // namespace

YamlMap::YamlMap(const YAML::Node& node, std::string path, std::shared_ptr<const std::string> file)
    : node_(node),
      path_(std::move(path)),
      file_(std::move(file)),
      known_(std::make_shared<std::vector<std::string>>()) {}

YamlMap YamlMap::from_file(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    throw ConfigError::at(path, 0, "", "no such file");
  if (std::filesystem::file_size(path, error) > kLargestFile)
    throw ConfigError::at(path, 0, "", "larger than 1 MiB");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw ConfigError::at(path, 0, "", "cannot be read");
  std::ostringstream text;
  text << stream.rdbuf();
  return from_text(text.str(), path);
}

YamlMap YamlMap::from_text(const std::string& text, const std::string& name) {
  if (text.size() > kLargestFile) throw ConfigError::at(name, 0, "", "larger than 1 MiB");
  if (text.find('\0') != std::string::npos)
    throw ConfigError::at(name, 0, "", "not text: it holds zero bytes");
  check_yaml_text(text, name);
  try {
    return YamlMap(YAML::Load(text), "", std::make_shared<std::string>(name));
  } catch (const YAML::Exception& error) {
    throw ConfigError::at(name, error.mark.line + 1, "", "not valid YAML: " + error.msg);
  }
}

YamlMap YamlMap::merged_with(const YamlMap& other) const {
  const std::string files = fmt::format("{} with {}", *file_, *other.file_);
  return YamlMap(merged(node_, other.node_), path_, std::make_shared<std::string>(files));
}

std::string YamlMap::path_to(const std::string& key) const {
  if (key.empty()) return path_;
  return path_.empty() ? key : path_ + "." + key;
}

void YamlMap::complain(const YAML::Node& node, const std::string& key,
                       const std::string& problem) const {
  // The parser marks an empty value, and a list or mapping below its key, lines further down.
  const YAML::Node& readonly = node_;
  const YAML::Node value = readonly[key];
  const bool whole_value = !node.IsDefined() || (value.IsDefined() && node.is(value));
  const int line = whole_value ? line_of(key) : node.Mark().line + 1;
  throw ConfigError::at(*file_, line, path_to(key), problem);
}

YAML::Node YamlMap::find(const std::string& key) const {
  if (std::find(known_->begin(), known_->end(), key) == known_->end()) known_->push_back(key);
  const YAML::Node& readonly = node_;
  return readonly[key];
}

YAML::Node YamlMap::need(const std::string& key, const std::string& what) const {
  YAML::Node node = find(key);
  if (!node.IsDefined()) refuse_missing(key, what);
  return node;
}

void YamlMap::refuse_missing(const std::string& key, const std::string& what) const {
  std::vector<std::string> present;
  for (const auto& entry : node_) present.push_back(entry.first.Scalar());
  std::erase_if(present, [&](const std::string& other) {
    return std::find(known_->begin(), known_->end(), other) != known_->end();
  });
  const std::string near = nearest_word(key, present);
  refuse("'" + key + "' is missing: " + what + (near.empty() ? "" : "; is '" + near + "' a slip?"));
}

bool YamlMap::has(const std::string& key) const { return find(key).IsDefined(); }
bool YamlMap::is_list(const std::string& key) const {
  const YAML::Node node = find(key);
  return node.IsDefined() && node.IsSequence();
}
bool YamlMap::is_map(const std::string& key) const {
  const YAML::Node node = find(key);
  return node.IsDefined() && node.IsMap();
}

double YamlMap::to_number(const std::string& key, const YAML::Node& node, Range allowed) const {
  if (!node.IsScalar())
    complain(node, key, fmt::format("found {}; expected {}", found(node), wanted(allowed)));
  const auto value = is_plain(node) ? parse_number(node.Scalar()) : std::nullopt;
  if (!value) {
    complain(node, key,
             fmt::format("{} is not a number; expected {}", found(node), wanted(allowed)));
  }
  if (!(*value >= allowed.low && *value <= allowed.high)) {
    const std::string hint = unit_hint(key, *value, allowed.low, allowed.high);
    complain(node, key,
             fmt::format("{} is out of range; expected {}{}", found(node), wanted(allowed), hint));
  }
  return *value;
}

double YamlMap::number(const std::string& key, Range allowed) const {
  return to_number(key, need(key, wanted(allowed)), allowed);
}

double YamlMap::number_or(const std::string& key, Range allowed, double otherwise) const {
  return has(key) ? number(key, allowed) : otherwise;
}

long YamlMap::integer(const std::string& key, long low, long high) const {
  const std::string what = fmt::format("a whole number from {} to {}", low, high);
  const YAML::Node node = need(key, what);
  long value = 0;
  std::string text = node.IsScalar() && is_plain(node) ? node.Scalar() : "";
  const bool hex = text.starts_with("0x") && !text.starts_with("0x-");  // as drives' makers write
  if (hex) text.erase(0, 2);
  const auto [end, error] =
      std::from_chars(text.data(), text.data() + text.size(), value, hex ? 16 : 10);
  if (text.empty() || error != std::errc() || end != text.data() + text.size())
    complain(node, key, fmt::format("found {}; expected {}", found(node), what));
  if (value < low || value > high)
    complain(node, key, fmt::format("{} is out of range; expected {}", found(node), what));
  return value;
}

long YamlMap::integer_or(const std::string& key, long low, long high, long otherwise) const {
  return has(key) ? integer(key, low, high) : otherwise;
}

bool YamlMap::boolean_or(const std::string& key, bool otherwise) const {
  const YAML::Node node = find(key);
  if (!node.IsDefined()) return otherwise;
  const std::string text = node.IsScalar() && is_plain(node) ? node.Scalar() : "";
  if (text != "true" && text != "false")
    complain(node, key, fmt::format("found {}; expected true or false", found(node)));
  return text == "true";
}

std::string YamlMap::text(const std::string& key) const {
  const YAML::Node node = need(key, "text");
  if (!node.IsScalar() || node.Scalar().empty())
    complain(node, key, fmt::format("found {}; expected text", found(node)));
  return node.Scalar();
}

std::string YamlMap::name(const std::string& key) const {
  const std::string name = text(key);
  if (const std::string problem = name_problem(name); !problem.empty()) refuse(key, problem);
  return name;
}

std::string YamlMap::text_or(const std::string& key, const std::string& otherwise) const {
  return has(key) ? text(key) : otherwise;
}

std::string YamlMap::word(const std::string& key, const std::vector<std::string>& allowed) const {
  const YAML::Node node = need(key, "one of: " + joined(allowed));
  std::string word = node.IsScalar() ? node.Scalar() : "";
  if (std::find(allowed.begin(), allowed.end(), word) == allowed.end()) {
    const std::string hint = did_you_mean(word, allowed);
    complain(node, key,
             fmt::format("found {}; expected one of: {}{}", found(node), joined(allowed),
                         hint.empty() ? "" : "; " + hint));
  }
  return word;
}

std::string YamlMap::word_or(const std::string& key, const std::vector<std::string>& allowed,
                             const std::string& otherwise) const {
  return has(key) ? word(key, allowed) : otherwise;
}

std::vector<double> YamlMap::numbers(const std::string& key, int size, Range allowed,
                                     bool broadcast) const {
  const std::string what =
      size < 0 ? "a list of numbers" : fmt::format("a list of {} numbers", size);
  const YAML::Node node = need(key, broadcast ? "a number or " + what : what);
  if (broadcast && node.IsScalar())
    return std::vector<double>(static_cast<std::size_t>(size), to_number(key, node, allowed));
  if (!node.IsSequence())
    complain(node, key, fmt::format("found {}; expected {}", found(node), what));
  if (size >= 0 && node.size() != static_cast<std::size_t>(size))
    complain(node, key, fmt::format("found {} entries; expected {}", node.size(), what));
  std::vector<double> values;
  for (const auto& entry : node) values.push_back(to_number(key, entry, allowed));
  return values;
}

std::vector<double> YamlMap::matrix(const std::string& key, int rows, int columns,
                                    Range allowed) const {
  const std::string what = fmt::format("{} lists of {} numbers", rows, columns);
  const YAML::Node node = need(key, what);
  std::vector<double> values;
  if (!node.IsSequence() || node.size() != static_cast<std::size_t>(rows))
    complain(node, key, fmt::format("found {}; expected {}", found(node), what));
  for (const auto& row : node) {
    if (!row.IsSequence() || row.size() != static_cast<std::size_t>(columns))
      complain(row, key, fmt::format("found {} as a row; expected {}", found(row), what));
    for (const auto& entry : row) values.push_back(to_number(key, entry, allowed));
  }
  return values;
}

YamlMap YamlMap::map(const std::string& key) const {
  const YAML::Node node = need(key, "a mapping");
  if (!node.IsMap()) complain(node, key, fmt::format("found {}; expected a mapping", found(node)));
  return YamlMap(node, path_to(key), file_);
}

std::vector<YamlMap> YamlMap::maps(const std::string& key) const {
  const YAML::Node node = need(key, "a list of mappings");
  if (!node.IsSequence())
    complain(node, key, fmt::format("found {}; expected a list of mappings", found(node)));
  std::vector<YamlMap> entries;
  for (const auto& entry : node) {
    const std::string path = fmt::format("{}[{}]", key, entries.size());
    if (!entry.IsMap())
      complain(entry, path, fmt::format("found {}; expected a mapping", found(entry)));
    entries.push_back(YamlMap(entry, path_to(path), file_));
  }
  return entries;
}

std::vector<std::string> YamlMap::keys() const {
  std::vector<std::string> names;
  for (const auto& entry : node_) {
    names.push_back(entry.first.Scalar());
    find(names.back());
  }
  return names;
}

void YamlMap::leave_to(const std::string& choice, const std::vector<std::string>& keys) const {
  const YAML::Node& readonly = node_;
  for (const std::string& key : keys) {
    const YAML::Node value = readonly[key];
    if (value.IsDefined())
      complain(value, key, fmt::format("{} belongs to {}; take it out", key, choice));
  }
}

std::string YamlMap::note(const std::string& key, const std::string& what) const {
  return ConfigError::at(*file_, line_of(key), path_to(key), what).what();
}

void YamlMap::finish() const {
  for (const auto& entry : node_) {
    const std::string key = entry.first.Scalar();
    if (std::find(known_->begin(), known_->end(), key) != known_->end()) continue;
    const std::string near = did_you_mean(key, *known_);
    const std::string hint = near.empty() ? "" : near + " ";
    throw ConfigError::at(
        *file_, entry.first.Mark().line + 1, path_,
        fmt::format("unknown key '{}'; {}allowed here: {}", key, hint, joined(*known_)));
  }
}

void YamlMap::refuse(const std::string& key, const std::string& problem) const {
  complain(find(key), key, problem);
}

void YamlMap::refuse(const std::string& problem) const { complain(node_, "", problem); }

int YamlMap::line_of(const std::string& key) const {
  for (const auto& entry : node_) {
    if (entry.first.Scalar() == key) return entry.first.Mark().line + 1;
  }
  return line();
}

int YamlMap::line() const { return node_.Mark().line + 1; }

}  // namespace limber
