// Which attributes of a URDF hold numbers, and what numbers they may be.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/complaints.h"
#include "robots/loader/xml_element.h"

namespace limber {

/// Numbers of an attribute, separated by blanks; empty if any of them is not one. No complaint.
std::vector<double> attribute_numbers(const XmlElement& element, const char* attribute);
/// The first of them, or `otherwise`.
double attribute_number(const XmlElement& element, const char* attribute, double otherwise);

/// A name with a prefix, as drake:acceleration: somebody's extension, which limber does not read.
bool is_foreign(std::string_view name);

/// Where the complaints about a part of a link or joint go, by the name of its element.
using ComplaintsOf = std::function<Complaints*(const std::string& tag)>;

/// Checks every number below a <link> or <joint>: finite, fully consumed, as many as there must be,
/// angles in radians; no attribute and no repeated element that would be ignored silently. `where`
/// names the link or joint, as in "link 'a'".
void check_urdf_numbers(const XmlElement& top, const std::string& where,
                        const ComplaintsOf& complaints_of);

}  // namespace limber
