// An adapter's settings against what robot.yaml has of its bus.
#pragma once

#include <string>
#include <vector>

#include "drivers/can/link_details.h"
#include "robots/loader/robot.h"

namespace limber {

/// `wrong`: no frame would be understood, or leave; `doubtful`: it works until something happens.
struct InterfaceFindings {
  std::vector<std::string> wrong;
  std::vector<std::string> doubtful;
};

/// Bit rates agree within 0.5 %: more is no rounding of the adapter's clock. An interface without
/// bit timing (vcan) has nothing to compare. Set-up only.
InterfaceFindings compare(const BusConfig& bus, const LinkDetails& link);

}  // namespace limber
