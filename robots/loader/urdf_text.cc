#include "robots/loader/urdf_text.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>

#include "common/complaints.h"
#include "common/config_error.h"
#include "common/suggest.h"
#include "robots/loader/urdf_inertial.h"
#include "robots/loader/urdf_rules.h"
#include "robots/loader/urdf_tree.h"

namespace limber {
namespace {

using tinyxml2::XMLElement;

constexpr std::uintmax_t kLargestFile = 8 << 20;
constexpr int kMostElements = 10'000;
constexpr double kLargestUrdfAngle_rad = 4.0 * std::numbers::pi;

const std::vector<std::string> kJointTypes = {"revolute", "continuous", "prismatic",
                                              "fixed",    "floating",   "planar"};

std::string read_file(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    throw ConfigError::at(path, 0, "", "no such file");
  if (std::filesystem::file_size(path, error) > kLargestFile)
    throw ConfigError::at(path, 0, "", "larger than 8 MiB");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw ConfigError::at(path, 0, "", "cannot be read");
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

int line_at(const std::string& text, std::size_t position) {
  return 1 + static_cast<int>(
                 std::count(text.begin(), text.begin() + static_cast<long>(position), '\n'));
}

/// The five characters that XML has names for, and nothing else: of a bare `&`, and of characters
/// by number, two parsers make different texts, and so different names.
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

/// What must not reach an XML parser at all.
void scan(const std::string& text, const std::string& path) {
  const auto zero = text.find('\0');
  if (zero != std::string::npos) {
    throw ConfigError::at(path, line_at(text, zero), "",
                          "not XML text: it holds a zero byte (is it UTF-8?)");
  }
  scan_references(text, path);
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
                            "holds xacro macros; expand them first: xacro FILE > robot.urdf");
    }
    ++at;
    if (at < text.size() && (std::isalpha(static_cast<unsigned char>(text[at])) != 0)) ++elements;
    if (elements > kMostElements)
      throw ConfigError::at(path, 0, "", fmt::format("more than {} elements", kMostElements));
  }
}

/// The name attribute, or empty after a complaint.
std::string name_of(const XMLElement& element, std::map<std::string, int>* lines,
                    Complaints* complaints) {
  const char* name = element.Attribute("name");
  const std::string tag = fmt::format("<{}>", element.Name());
  if (name == nullptr || *name == '\0') {
    complaints->add(element.GetLineNum(), tag, "has no name");
    return "";
  }
  const auto [earlier, added] = lines->emplace(name, element.GetLineNum());
  if (!added) {
    complaints->add(element.GetLineNum(), tag,
                    fmt::format("the name '{}' is taken by line {}", name, earlier->second));
  }
  return name;
}

std::string link_of(const XMLElement& joint, const char* end, const std::string& where,
                    Complaints* complaints) {
  const XMLElement* element = joint.FirstChildElement(end);
  const char* link = element == nullptr ? nullptr : element->Attribute("link");
  if (link != nullptr && *link != '\0') return link;
  complaints->add(joint.GetLineNum(), where, fmt::format("<{} link=\"...\"/> is missing", end));
  return "";
}

void check_axis(const XMLElement& joint, const std::string& where, UrdfText* urdf,
                Complaints* complaints) {
  const XMLElement* axis = joint.FirstChildElement("axis");
  if (axis == nullptr) return;
  const auto xyz = attribute_numbers(*axis, "xyz");
  if (xyz.size() != 3) return;
  const double length = std::hypot(xyz[0], xyz[1], xyz[2]);
  if (!(length > 1e-6)) {
    complaints->add(axis->GetLineNum(), where, "<axis> xyz: the axis has no length");
  } else if (std::abs(length - 1.0) > 1e-3) {
    urdf->notes.push_back(fmt::format("{}: axis of length {:.6g} normalised (line {})", where,
                                      length, axis->GetLineNum()));
  }
}

void check_limit(const XMLElement& joint, const std::string& type, const std::string& where,
                 Complaints* complaints) {
  if (type != "revolute" && type != "prismatic") return;
  const XMLElement* limit = joint.FirstChildElement("limit");
  if (limit == nullptr) {
    complaints->add(joint.GetLineNum(), where,
                    fmt::format("a {} joint needs <limit lower upper effort velocity>", type));
    return;
  }
  const double lower = attribute_number(*limit, "lower", 0.0);
  const double upper = attribute_number(*limit, "upper", 0.0);
  if (!(lower <= upper)) {
    complaints->add(limit->GetLineNum(), where,
                    fmt::format("<limit>: lower {} is above upper {}", lower, upper));
  }
  if (type == "revolute" && std::max(std::abs(lower), std::abs(upper)) > kLargestUrdfAngle_rad) {
    complaints->add(limit->GetLineNum(), where,
                    fmt::format("<limit>: {} to {} rad is more than two turns; are these degrees?",
                                lower, upper));
  }
}

UrdfJointText check_joint(const XMLElement& joint, UrdfText* urdf, Complaints* complaints) {
  UrdfJointText found;
  found.line = joint.GetLineNum();
  found.name = name_of(joint, &urdf->joint_lines, complaints);
  const std::string where = fmt::format("joint '{}'", found.name);
  const char* type = joint.Attribute("type");
  const std::string type_name = type == nullptr ? "" : type;
  if (std::find(kJointTypes.begin(), kJointTypes.end(), type_name) == kJointTypes.end()) {
    complaints->add(joint.GetLineNum(), where,
                    fmt::format("type '{}'; expected one of: {}", type_name, joined(kJointTypes)));
  }
  found.parent = link_of(joint, "parent", where, complaints);
  found.child = link_of(joint, "child", where, complaints);
  check_urdf_numbers(joint, where, complaints);
  check_axis(joint, where, urdf, complaints);
  check_limit(joint, type_name, where, complaints);
  if (joint.FirstChildElement("mimic") != nullptr)
    urdf->notes.push_back(where + ": mimic is ignored");
  return found;
}

void check_link(const XMLElement& link, UrdfText* urdf, Complaints* complaints) {
  const std::string where = fmt::format("link '{}'", name_of(link, &urdf->link_lines, complaints));
  check_urdf_numbers(link, where, complaints);
  if (const XMLElement* inertial = link.FirstChildElement("inertial"))
    check_urdf_inertial(*inertial, where, complaints);
}

}  // namespace

UrdfText read_urdf_text(const std::string& path) {
  UrdfText urdf;
  urdf.file = path;
  urdf.text = read_file(path);
  scan(urdf.text, path);
  tinyxml2::XMLDocument document;
  if (document.Parse(urdf.text.c_str(), urdf.text.size()) != tinyxml2::XML_SUCCESS) {
    throw ConfigError::at(path, document.ErrorLineNum(), "",
                          fmt::format("not well-formed XML ({})", document.ErrorName()));
  }
  const XMLElement* root = document.RootElement();
  if (root == nullptr || std::string(root->Name()) != "robot")
    throw ConfigError::at(path, 0, "", "no <robot> at the top: not a URDF");

  Complaints complaints(path);
  std::vector<UrdfJointText> joints;
  for (auto* element = root->FirstChildElement(); element;
       element = element->NextSiblingElement()) {
    const std::string tag = element->Name();
    if (tag == "link") check_link(*element, &urdf, &complaints);
    if (tag == "joint") joints.push_back(check_joint(*element, &urdf, &complaints));
  }
  check_urdf_tree(urdf.link_lines, joints, &complaints);
  complaints.throw_if_any();
  return urdf;
}

}  // namespace limber
