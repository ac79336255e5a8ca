// Other masters of an ODrive drive.
#include <array>

#include "drivers/families/odrive_family.h"

namespace limber {
namespace {

class OdriveIntruders final : public IntruderRules {
 public:
  explicit OdriveIntruders(const DriveConfig& drive) : node_(odrive_node(drive)) {}

  void begin_cycle() noexcept override { asked_.fill(0); }
  /// Whatever neither asks nor is told by a drive.
  bool is_foreign_command(const CanFrame& frame) const noexcept override {
    if (!concerns(frame) || frame.remote) return false;
    const odrive::Layout* layout = odrive::layout_of(frame.id);
    if (layout != nullptr && layout->from_drive) return false;
    if (layout != nullptr && layout->message == odrive::Message::kWriteEndpoint)
      return frame.length == 0 || frame.data[0] != 0;
    return true;
  }
  void record_foreign(const CanFrame& frame) noexcept override {
    const bool reads = odrive::is_message(frame, node_, odrive::Message::kWriteEndpoint, 4);
    if (concerns(frame) && (odrive::asks(frame) || reads))
      ++asked_[message(frame) + (reads ? 1 : 0)];
  }
  bool answers_foreign(const CanFrame& frame) noexcept override {
    if (frame.remote || asked_[message(frame)] == 0) return false;
    --asked_[message(frame)];
    return true;
  }

 private:
  static std::size_t message(const CanFrame& frame) noexcept { return frame.id & 0x1FU; }
  bool concerns(const CanFrame& frame) const noexcept {
    const std::uint32_t node = odrive::node_of(frame.id);
    return !frame.extended && !frame.error && (node == node_ || node == odrive::kEverybody);
  }

  std::uint32_t node_;
  std::array<int, 33> asked_{};  ///< in this cycle, by message
};

}  // namespace

std::unique_ptr<IntruderRules> odrive_intruders(const JointConfig& joint) {
  return std::make_unique<OdriveIntruders>(joint.drive);
}

}  // namespace limber
