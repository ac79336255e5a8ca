// Refuses masses and inertias that no body has.
#pragma once

#include <tinyxml2.h>

#include <string>

#include "common/complaints.h"

namespace limber {

/// <inertial>: one mass in (0, 1000] kg; one inertia, positive definite, no principal moment larger
/// than the sum of the other two (to 1e-9). Or all of it zero: a link without mass. `where` names
/// the link, as in "link 'a'". Attributes that are not numbers are left to check_urdf_numbers().
void check_urdf_inertial(const tinyxml2::XMLElement& inertial, const std::string& where,
                         Complaints* complaints);

}  // namespace limber
