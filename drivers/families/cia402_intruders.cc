// Other masters of a CiA 402 drive.
#include "drivers/families/cia402_family.h"
#include "drivers/protocols/canopen.h"
#include "drivers/protocols/canopen_sdo.h"

namespace limber {
namespace {

class Cia402Intruders final : public IntruderRules {
 public:
  explicit Cia402Intruders(const DriveConfig& drive) : node_(canopen::node_of(drive.command_id)) {}

  /// RPDOs, SDO requests that write, network management and SYNC.
  bool is_foreign_command(const CanFrame& frame) const noexcept override;

 private:
  std::uint8_t node_;
};

bool Cia402Intruders::is_foreign_command(const CanFrame& frame) const noexcept {
  if (has_id(frame, canopen::kSyncId)) return true;
  canopen::NmtCommand command;
  if (canopen::decode_nmt(frame, node_, &command)) return true;
  for (std::uint32_t k = 0; k < canopen::kPdos; ++k) {
    if (has_id(frame, canopen::kRpdo1Code + k * canopen::kPdoStep + node_)) return true;
  }
  return has_id(frame, canopen::kSdoRequestCode + node_) && canopen::is_sdo_write(frame);
}

}  // namespace

std::unique_ptr<IntruderRules> cia402_intruders(const JointConfig& joint) {
  return std::make_unique<Cia402Intruders>(joint.drive);
}

}  // namespace limber
