// Start-up of CubeMars drives: there is nothing to read. That its reply is as long as the board in
// robot.yaml makes it, and that it is not in servo mode, is all that shows.
#include <fmt/format.h>

#include "drivers/families/cubemars_family.h"
#include "drivers/protocols/cubemars.h"

namespace limber {
namespace {

class CubemarsStartup final : public StartupDialogue {
 public:
  explicit CubemarsStartup(const DriveConfig& drive) : drive_(drive) {}

  CanFrame presence_request() const noexcept override { return cubemars::off_frame(drive_); }
  bool is_presence(const CanFrame& frame) const noexcept override {
    return cubemars::is_from(frame, drive_);
  }
  /// Not in servo mode.
  bool disable_is_answered() const noexcept override { return false; }

  int steps() const noexcept override { return 1; }
  StartupStep step(int /*index*/) const noexcept override {
    return {kReplyLength, drive_.board == cubemars::kV1 ? 6.0 : 8.0};
  }
  CanFrame request(int /*index*/) const noexcept override { return cubemars::off_frame(drive_); }
  Answer check_answer(int /*index*/, const CanFrame& frame, double* found) noexcept override {
    if (!is_presence(frame)) return Answer::kNone;
    *found = cubemars::is_servo_state(frame, drive_) ? kServo : frame.length;
    cubemars::State state;
    return cubemars::decode_state(frame, drive_, &state) ? Answer::kRight : Answer::kWrong;
  }
  std::string describe(const StartupFailure& failure) const override {
    if (failure.reg == 0 || failure.answer == Answer::kNone)
      return "it does not answer; is it in MIT mode?";
    if (failure.found == kServo) return "it is in servo mode: its maker's tool sets MIT mode";
    return fmt::format(
        "its replies have {:g} bytes, those of a board V{} {:g}; 6 are of V1, 8 of V2",
        failure.found, drive_.board, failure.expected);
  }

 private:
  static constexpr std::uint32_t kReplyLength = 1;
  static constexpr double kServo = -1.0;

  DriveConfig drive_;
};

}  // namespace

std::unique_ptr<StartupDialogue> cubemars_startup(const JointConfig& joint) {
  return std::make_unique<CubemarsStartup>(joint.drive);
}

}  // namespace limber
