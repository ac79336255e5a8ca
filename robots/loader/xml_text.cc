#include "robots/loader/xml_text.h"

#include <expat.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include "common/config_error.h"

namespace limber {
namespace {

constexpr std::size_t kDeepest = 100;  ///< elements; what follows may be recursive

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
  if (error == XML_ERROR_ABORTED)
    return fmt::format("; elements may be {} deep, one in another", kDeepest);
  if (error != XML_ERROR_INVALID_TOKEN) return "";
  if (at < text.size() && static_cast<unsigned char>(text[at]) > 0x7F)
    return "; is the file UTF-8? `iconv -f ENCODING -t UTF-8` converts it";
  return in_comment(text, at) ? "; two dashes are not allowed inside a comment" : "";
}

/// What expat has met so far.
struct Document {
  XML_Parser parser;
  std::string encoding;                    ///< as declared
  XmlElement top;                          ///< its only child is the root
  std::vector<XmlElement*> open = {&top};  ///< vectors of children grow at their end alone
};

void begin_element(void* user, const XML_Char* name, const XML_Char** attributes) {
  auto* document = static_cast<Document*>(user);
  if (document->open.size() > kDeepest) {
    XML_StopParser(document->parser, XML_FALSE);
    return;
  }
  XmlElement& element = document->open.back()->children.emplace_back();
  element.name = name;
  element.line = static_cast<int>(XML_GetCurrentLineNumber(document->parser));
  for (; *attributes != nullptr; attributes += 2)
    element.attributes.emplace_back(attributes[0], attributes[1]);
  document->open.push_back(&element);
}

void end_element(void* user, const XML_Char*) { static_cast<Document*>(user)->open.pop_back(); }

void declare(void* user, const XML_Char*, const XML_Char* encoding, int) {
  if (encoding != nullptr) static_cast<Document*>(user)->encoding = encoding;
}

}  // namespace

int line_at(const std::string& text, std::size_t position) {
  return 1 + static_cast<int>(
                 std::count(text.begin(), text.begin() + static_cast<long>(position), '\n'));
}

XmlElement parse_xml(const std::string& text, const std::string& path) {
  // The encoding given here overrides the declared one; ASCII is the same in both.
  const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(
      XML_ParserCreate("UTF-8"), &XML_ParserFree);
  Document document;
  document.parser = parser.get();
  XML_SetUserData(parser.get(), &document);
  XML_SetXmlDeclHandler(parser.get(), declare);
  XML_SetElementHandler(parser.get(), begin_element, end_element);
  const bool read = XML_Parse(parser.get(), text.data(), static_cast<int>(text.size()), XML_TRUE) ==
                    XML_STATUS_OK;
  const std::string& declared = document.encoding;
  const std::size_t beyond = first_beyond_ascii(text);
  if (beyond != text.size() && !is_utf8(declared)) {
    throw ConfigError::at(
        path, line_at(text, beyond), "",
        fmt::format("characters in the encoding '{}'; limber reads UTF-8: iconv -f {} -t UTF-8 {} "
                    "> {}, and take encoding=\"{}\" out of the new file's first line",
                    declared, declared, path, converted_name(path), declared));
  }
  if (read) return std::move(document.top.children.front());
  const XML_Error error = XML_GetErrorCode(parser.get());
  const auto at =
      static_cast<std::size_t>(std::max<long>(XML_GetCurrentByteIndex(parser.get()), 0));
  throw ConfigError::at(
      path, static_cast<int>(XML_GetCurrentLineNumber(parser.get())), "",
      fmt::format("not well-formed XML: {} (column {}){}", XML_ErrorString(error),
                  XML_GetCurrentColumnNumber(parser.get()) + 1, hint(text, at, error)));
}

}  // namespace limber
