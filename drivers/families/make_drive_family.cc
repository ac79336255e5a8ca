#include "drivers/families/cia402_family.h"
#include "drivers/families/damiao_family.h"
#include "drivers/families/moteus_family.h"

namespace limber {

std::unique_ptr<DriveFamily> make_drive_family(const JointConfig& joint, bool fd, double period_s) {
  switch (joint.drive.protocol) {
    case DriveProtocol::kMoteus:
      return std::make_unique<MoteusFamily>(joint);
    case DriveProtocol::kCia402:
      return std::make_unique<Cia402Family>(joint, fd, period_s);
    case DriveProtocol::kDamiaoMit:
      break;
  }
  return std::make_unique<DamiaoFamily>(joint, fd);
}

}  // namespace limber
