// The list of families that faults are injected into, and nothing else: docs/adding.md.
#include "qa/faults/families.h"

#include <array>

#include "robots/loader/protocols/drive_protocol.h"

namespace limber::faults {

std::span<const Family> families() {
  static constexpr std::array kFamilies = {
      Family{"damiao_mit", "desktop2r", with_motion_of_damiao},
      Family{"moteus", "planar2r", with_motion_of_moteus},
      Family{"cia402", "iiwa14", with_motion_of_cia402},
      Family{"robstride", "edulite_a3", with_motion_of_robstride},
      Family{"myactuator", "axol", with_motion_of_myactuator},
      Family{"cubemars", "desktop2r_ak", with_motion_of_cubemars},
      Family{"odrive", "desktop2r_odrive", with_motion_of_odrive},
  };
  return kFamilies;
}

const Family& family_of(const DriveConfig& drive) { return row_of(families(), *drive.protocol); }

}  // namespace limber::faults
