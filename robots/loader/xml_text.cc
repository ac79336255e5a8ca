#include "robots/loader/xml_text.h"

#include <expat.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "common/config_error.h"

namespace limber {
namespace {

std::size_t first_beyond_ascii(const std::string& text) {
  const auto found =
      std::ranges::find_if(text, [](char c) { return static_cast<unsigned char>(c) > 0x7F; });
  return static_cast<std::size_t>(found - text.begin());
}

bool is_utf8(std::string encoding) {
  std::ranges::transform(encoding, encoding.begin(),
                         [](unsigned char c) { return std::toupper(c); });
  return encoding.empty() || encoding == "UTF-8" || encoding == "UTF8";
}

std::string converted_name(const std::filesystem::path& path) {
  return (path.parent_path() / (path.stem().string() + "_utf8.urdf")).string();
}

/// A comment that is open at `end`, so that two dashes in it are what is wrong.
bool in_comment(const std::string& text, std::size_t end) {
  const auto opened = text.rfind("<!--", end);
  return opened != std::string::npos && text.find("-->", opened + 4) + 3 > end;
}

std::string hint(const std::string& text, std::size_t at, XML_Error error) {
  if (error != XML_ERROR_INVALID_TOKEN) return "";
  if (at < text.size() && static_cast<unsigned char>(text[at]) > 0x7F)
    return "; is the file UTF-8? `iconv -f ENCODING -t UTF-8` converts it";
  return in_comment(text, at) ? "; two dashes are not allowed inside a comment" : "";
}

}  // namespace

int line_at(const std::string& text, std::size_t position) {
  return 1 + static_cast<int>(
                 std::count(text.begin(), text.begin() + static_cast<long>(position), '\n'));
}

void check_xml_text(const std::string& text, const std::string& path) {
  // The encoding given here overrides the declared one; ASCII is the same in both.
  const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(
      XML_ParserCreate("UTF-8"), &XML_ParserFree);
  std::string declared;
  XML_SetUserData(parser.get(), &declared);
  XML_SetXmlDeclHandler(parser.get(),
                        [](void* user, const XML_Char*, const XML_Char* encoding, int) {
                          if (encoding != nullptr) *static_cast<std::string*>(user) = encoding;
                        });
  const bool read = XML_Parse(parser.get(), text.data(), static_cast<int>(text.size()), XML_TRUE) ==
                    XML_STATUS_OK;
  const std::size_t beyond = first_beyond_ascii(text);
  if (beyond != text.size() && !is_utf8(declared)) {
    throw ConfigError::at(
        path, line_at(text, beyond), "",
        fmt::format("characters in the encoding '{}'; limber reads UTF-8: iconv -f {} -t UTF-8 {} "
                    "> {}, and take encoding=\"{}\" out of the new file's first line",
                    declared, declared, path, converted_name(path), declared));
  }
  if (read) return;
  const XML_Error error = XML_GetErrorCode(parser.get());
  const auto at =
      static_cast<std::size_t>(std::max<long>(XML_GetCurrentByteIndex(parser.get()), 0));
  throw ConfigError::at(
      path, static_cast<int>(XML_GetCurrentLineNumber(parser.get())), "",
      fmt::format("not well-formed XML: {} (column {}){}", XML_ErrorString(error),
                  XML_GetCurrentColumnNumber(parser.get()) + 1, hint(text, at, error)));
}

}  // namespace limber
