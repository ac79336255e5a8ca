// Masses and inertias: what no body can have is refused; what is only odd is told.
#pragma once

#include <string>
#include <vector>

#include "common/complaints.h"
#include "robots/loader/xml_element.h"

namespace limber {

/// A link with an inertia that no body has.
struct UnphysicalLink {
  std::string link;
  int line = 0;
  double smallest_moment_kgm2 = 0.0;  ///< principal
};

/// Where the findings of an <inertial> go.
struct InertialFindings {
  Complaints* refused;
  Complaints* told;
  std::string consequence;  ///< ends what is told
  std::vector<UnphysicalLink>* unphysical;
};

/// Refused: <mass> or <inertia> missing, a mass below zero or above 10,000 kg, a principal moment
/// further below zero than a tenth of the largest. Told: masses above 1,000 kg, mass without
/// inertia, inertia without mass, and inertias that no body has (a moment slightly below zero, or
/// greater than the sum of the other two, to 1e-9), which also go to `unphysical`. All of it zero
/// is a link without mass. Attributes that are not numbers are left to check_urdf_numbers().
void check_urdf_inertial(const XmlElement& inertial, const std::string& link,
                         const InertialFindings& findings);

}  // namespace limber
