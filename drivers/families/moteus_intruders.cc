// Other masters of a moteus drive.
#include "drivers/families/moteus_family.h"
#include "robots/loader/protocols/drive_protocol.h"

namespace limber {
namespace {

class MoteusIntruders final : public IntruderRules {
 public:
  explicit MoteusIntruders(const DriveConfig& drive) : drive_(drive) {}

  /// Frames for its number, or for all, whoever they are from.
  bool is_foreign_command(const CanFrame& frame) const noexcept override {
    // Bits 16 to 28 are the prefix, which must be the drive's; a reply is for host 0.
    const bool prefix = frame.id >> 16U == drive_.command_id >> 16U;
    return !frame.error && prefix && accepts_id(drive_, frame.id);
  }

 private:
  DriveConfig drive_;
};

}  // namespace

std::unique_ptr<IntruderRules> moteus_intruders(const JointConfig& joint) {
  return std::make_unique<MoteusIntruders>(joint.drive);
}

}  // namespace limber
