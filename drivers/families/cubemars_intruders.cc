// Other masters of a CubeMars drive.
#include "drivers/families/cubemars_family.h"
#include "drivers/protocols/cubemars.h"

namespace limber {
namespace {

class CubemarsIntruders final : public IntruderRules {
 public:
  explicit CubemarsIntruders(const DriveConfig& drive) : drive_(drive) {}
  bool is_foreign_command(const CanFrame& frame) const noexcept override {
    return cubemars::is_to(frame, drive_);
  }

 private:
  DriveConfig drive_;
};

}  // namespace

std::unique_ptr<IntruderRules> cubemars_intruders(const JointConfig& joint) {
  return std::make_unique<CubemarsIntruders>(joint.drive);
}

}  // namespace limber
