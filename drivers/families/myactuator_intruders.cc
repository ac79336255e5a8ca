// Other masters of a MyActuator drive.
#include <bitset>

#include "drivers/families/myactuator_family.h"
#include "drivers/protocols/myactuator.h"

namespace limber {
namespace {

class MyactuatorIntruders final : public IntruderRules {
 public:
  explicit MyactuatorIntruders(const DriveConfig& drive)
      : motion_id_(drive.command_id),
        number_(static_cast<std::uint32_t>(myactuator_number(drive))) {}

  bool is_foreign_command(const CanFrame& frame) const noexcept override {
    if (has_id(frame, motion_id_)) return true;
    if (has_id(frame, myactuator::kSetNumberId)) return frame.data[2] == 0;  // 1: reads it
    return is_order(frame) && !myactuator::only_reads(frame.data[0]);
  }
  void record_foreign(const CanFrame& frame) noexcept override {
    if (is_order(frame) && myactuator::only_reads(frame.data[0])) open_.set(frame.data[0]);
  }
  /// Those to reads that the driver does not make in its cycle: of one that it does, every answer
  /// is as good as its own.
  bool answers_foreign(const CanFrame& frame) noexcept override {
    if (!has_id(frame, myactuator::kAnswerId + number_) || !open_.test(frame.data[0])) return false;
    open_.reset(frame.data[0]);
    return true;
  }

 private:
  bool is_order(const CanFrame& frame) const noexcept {
    return has_id(frame, myactuator::kOrderId + number_) ||
           has_id(frame, myactuator::kEveryMotorId);
  }

  std::uint32_t motion_id_;
  std::uint32_t number_;
  std::bitset<256> open_;  ///< orders
};

}  // namespace

std::unique_ptr<IntruderRules> myactuator_intruders(const JointConfig& joint) {
  return std::make_unique<MyactuatorIntruders>(joint.drive);
}

}  // namespace limber
