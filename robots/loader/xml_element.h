// The elements of an XML file, each with its line.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace limber {

/// Names keep their prefix, as in drake:joint. Text between elements is left out.
struct XmlElement {
  std::string name;
  int line = 0;
  std::vector<std::pair<std::string, std::string>> attributes;  ///< in file order
  std::vector<XmlElement> children;                             ///< likewise

  /// The value; nullptr if there is none of that name.
  const char* attribute(std::string_view key) const {
    for (const auto& [given, value] : attributes) {
      if (given == key) return value.c_str();
    }
    return nullptr;
  }
  /// The first of that name, nullptr without one.
  const XmlElement* child(std::string_view tag) const {
    for (const XmlElement& element : children) {
      if (element.name == tag) return &element;
    }
    return nullptr;
  }
};

}  // namespace limber
