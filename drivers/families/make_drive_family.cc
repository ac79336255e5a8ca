#include "drivers/families/damiao_family.h"
#include "drivers/families/moteus_family.h"

namespace limber {

std::unique_ptr<DriveFamily> make_drive_family(const JointConfig& joint, bool fd) {
  switch (joint.drive.protocol) {
    case DriveProtocol::kMoteus:
      return std::make_unique<MoteusFamily>(joint);
    case DriveProtocol::kCia402:
    case DriveProtocol::kDamiaoMit:
      break;
  }
  return std::make_unique<DamiaoFamily>(joint, fd);
}

}  // namespace limber
