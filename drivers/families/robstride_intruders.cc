// Other masters of a RobStride drive.
#include "drivers/families/robstride_family.h"
#include "drivers/protocols/robstride.h"

namespace limber {
namespace {

using robstride::Type;

class RobstrideIntruders final : public IntruderRules {
 public:
  explicit RobstrideIntruders(const DriveConfig& drive) : number_(robstride_number(drive)) {}

  /// Whatever goes to the motor but a ping and a read.
  bool is_foreign_command(const CanFrame& frame) const noexcept override {
    robstride::Id id{};
    return robstride::split(frame, &id) && id.target == number_ && id.type != Type::kPing &&
           id.type != Type::kRead && id.type != Type::kState;
  }
  void record_foreign(const CanFrame& frame) noexcept override {
    robstride::Id id{};
    if (!robstride::split(frame, &id) || id.target != number_) return;
    if (id.type == Type::kRead || id.type == Type::kPing) open_ = open_ < kMost ? open_ + 1 : open_;
  }
  /// Answers to pings and reads: they are no states, whoever requested them.
  bool answers_foreign(const CanFrame& frame) noexcept override {
    robstride::Id id{};
    if (open_ == 0 || !robstride::split(frame, &id) ||
        static_cast<std::uint8_t>(id.data) != number_)
      return false;
    if (id.target <= robstride::kLastMotor || (id.type != Type::kRead && id.type != Type::kPing))
      return false;
    --open_;
    return true;
  }

 private:
  static constexpr int kMost = 8;  // nobody requests more at a time

  std::uint8_t number_;
  int open_ = 0;
};

}  // namespace

std::unique_ptr<IntruderRules> robstride_intruders(const JointConfig& joint) {
  return std::make_unique<RobstrideIntruders>(joint.drive);
}

}  // namespace limber
