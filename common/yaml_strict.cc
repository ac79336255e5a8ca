#include "common/yaml_strict.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <map>
#include <sstream>
#include <vector>

#include "common/config_error.h"

namespace limber {
namespace {

constexpr std::size_t kDeepest = 12;

class StrictHandler : public YAML::EventHandler {
 public:
  explicit StrictHandler(const std::string& file) : file_(file) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (documents_++ > 0) refuse(mark, "a second document; one file holds one");
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    value(mark, anchor, "");
    if (levels_.empty()) refuse(mark, "the file is empty; expected a mapping");
    if (is_key()) refuse(mark, "a key is missing");
    next();
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    refuse(mark, "aliases (*name) are not allowed; write the value out");
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& text) override {
    value(mark, anchor, tag);
    if (levels_.empty()) refuse(mark, "expected a mapping (key: value), found text");
    if (is_key()) key(mark, text);
    next();
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    value(mark, anchor, tag);
    if (levels_.empty()) refuse(mark, "expected a mapping (key: value), found a list");
    enter(mark, false);
  }
  void OnSequenceEnd() override { leave(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    value(mark, anchor, tag);
    enter(mark, true);
  }
  void OnMapEnd() override { leave(); }

 private:
  struct Level {
    bool mapping = false;
    bool key_next = false;
    std::map<std::string, int> lines;  ///< of the keys so far
  };

  [[noreturn]] void refuse(const YAML::Mark& mark, const std::string& problem) const {
    throw ConfigError::at(file_, mark.line + 1, "", problem);
  }
  void value(const YAML::Mark& mark, YAML::anchor_t anchor, const std::string& tag) const {
    if (anchor != 0) refuse(mark, "anchors (&name) are not allowed");
    const bool plain_or_quoted = tag.empty() || tag == "?" || tag == "!";
    if (!plain_or_quoted) refuse(mark, "tags (" + tag + ") are not allowed");
  }
  bool is_key() const {
    return !levels_.empty() && levels_.back().mapping && levels_.back().key_next;
  }
  void key(const YAML::Mark& mark, const std::string& text) {
    const auto [earlier, added] = levels_.back().lines.emplace(text, mark.line + 1);
    if (!added) {
      refuse(mark,
             "key '" + text + "' is here twice; first on line " + std::to_string(earlier->second));
    }
  }
  void next() {
    Level& level = levels_.back();
    if (level.mapping) level.key_next = !level.key_next;
  }
  void enter(const YAML::Mark& mark, bool mapping) {
    if (is_key()) refuse(mark, "a key must be a word");
    if (levels_.size() == kDeepest) refuse(mark, "nested too deeply");
    levels_.push_back({mapping, mapping, {}});
  }
  void leave() {
    levels_.pop_back();
    if (!levels_.empty()) next();
  }

  const std::string& file_;
  std::vector<Level> levels_;
  int documents_ = 0;
};

/// `number` counts from 0.
bool tab_in_line(const std::string& text, int number) {
  std::istringstream lines(text);
  std::string line;
  for (int i = 0; i <= number; ++i) {
    if (!std::getline(lines, line)) return false;
  }
  return line.find('\t') != std::string::npos;
}

}  // namespace

void check_yaml_text(const std::string& text, const std::string& file) {
  std::istringstream stream(text);
  StrictHandler handler(file);
  try {
    YAML::Parser parser(stream);
    bool any = false;
    while (parser.HandleNextDocument(handler)) any = true;
    if (!any) throw ConfigError::at(file, 0, "", "the file is empty; expected a mapping");
  } catch (const YAML::Exception& error) {
    const std::string tab = tab_in_line(text, error.mark.line)
                                ? "; this line holds a tab, and YAML is indented by spaces"
                                : "";
    throw ConfigError::at(file, error.mark.line + 1, "", "not valid YAML: " + error.msg + tab);
  }
}

}  // namespace limber
