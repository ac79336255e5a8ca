#include "robots/loader/urdf_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "common/config_error.h"
#include "robots/loader/xml_text.h"

namespace limber {
namespace {

constexpr std::uintmax_t kLargestUrdf = 8 << 20;
constexpr int kMostElements = 10'000;

std::string read_text(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    throw ConfigError::at(path, 0, "", "no such file");
  if (std::filesystem::file_size(path, error) > kLargestUrdf)
    throw ConfigError::at(path, 0, "", "larger than 8 MiB");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw ConfigError::at(path, 0, "", "cannot be read");
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// The five characters that XML has names for, and nothing else: no name holds others.
bool is_named_character(const std::string& text, std::size_t at) {
  return std::ranges::any_of(
      std::array{"&amp;", "&lt;", "&gt;", "&quot;", "&apos;"},
      [&](const std::string& name) { return text.compare(at, name.size(), name) == 0; });
}

void scan_references(const std::string& text, const std::string& path) {
  for (auto at = text.find_first_of("&<"); at != std::string::npos;
       at = text.find_first_of("&<", at + 1)) {
    if (text.compare(at, 4, "<!--") == 0) at = std::min(text.find("-->", at + 4), text.size());
    if (at == text.size() || text[at] != '&' || is_named_character(text, at)) continue;
    throw ConfigError::at(path, line_at(text, at), "",
                          "'&' begins none of &amp; &lt; &gt; &quot; &apos;");
  }
}

/// The command that makes a URDF of a xacro file: arm.urdf.xacro and arm.xacro give arm.urdf.
std::string xacro_command(const std::filesystem::path& path) {
  std::filesystem::path name = path.filename();
  while (name.extension() == ".xacro" || name.extension() == ".urdf") name = name.stem();
  const bool same = name.string() + ".urdf" == path.filename();
  return fmt::format("xacro {} > {}{}.urdf", path.string(), name.string(), same ? "_expanded" : "");
}

void scan(const std::string& text, const std::string& path) {
  const auto zero = text.find('\0');
  if (zero != std::string::npos) {
    throw ConfigError::at(path, line_at(text, zero), "",
                          "not XML text: it holds a zero byte (is it UTF-8?)");
  }
  int elements = 0;
  for (auto at = text.find('<'); at != std::string::npos; at = text.find('<', at)) {
    if (text.compare(at, 4, "<!--") == 0) {
      at = text.find("-->", at);
      continue;
    }
    if (text.compare(at, 2, "<!") == 0 && text.compare(at, 9, "<![CDATA[") != 0) {
      throw ConfigError::at(path, line_at(text, at), "",
                            "document types and entities (<!...>) are not allowed");
    }
    if (text.compare(at, 7, "<xacro:") == 0) {
      throw ConfigError::at(path, line_at(text, at), "",
                            "holds xacro macros; expand them first: " + xacro_command(path));
    }
    ++at;
    if (at < text.size() && (std::isalpha(static_cast<unsigned char>(text[at])) != 0)) ++elements;
    if (elements > kMostElements)
      throw ConfigError::at(path, 0, "", fmt::format("more than {} elements", kMostElements));
  }
  scan_references(text, path);
}

bool is_known_version(const std::string& version) {
  return std::ranges::any_of(std::array{"1.0", "1.1", "1.2", "1"},
                             [&](const char* known) { return version == known; });
}

}  // namespace

XmlElement read_urdf_file(const std::string& path) {
  const std::string text = read_text(path);
  scan(text, path);
  XmlElement root = parse_xml(text, path);
  if (root.name != "robot") throw ConfigError::at(path, 0, "", "no <robot> at the top: not a URDF");
  const char* version = root.attribute("version");
  if (version != nullptr && !is_known_version(version)) {
    throw ConfigError::at(
        path, root.line, "<robot>",
        fmt::format("version \"{}\"; limber reads URDF 1.0, 1.1 and 1.2", version));
  }
  return root;
}

}  // namespace limber
