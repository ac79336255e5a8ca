#include <algorithm>
#include <limits>

#include "tests/added_family/toy.h"

namespace limber {
namespace {

class ToyCodec final : public DriveCodec {
 public:
  explicit ToyCodec(const JointConfig& joint) : drive_(joint.drive), most_(joint.torque_limit_Nm) {}

  bool command(const DriveCommand& command, const DriveMemory& /*memory*/, CanFrame* frame,
               DriveCommand* sent) noexcept override {
    if (!all_finite(command)) return false;
    *sent = command;
    sent->torque_Nm = std::clamp(command.torque_Nm, -most_, most_);
    const auto f = [](double value) { return static_cast<float>(value); };
    *frame = encode({toy::kOn,
                     {f(sent->angle_rad), f(sent->speed_rad_per_s), f(sent->kp_Nm_per_rad),
                      f(sent->kd_Nms_per_rad), f(sent->torque_Nm)}});
    return true;
  }
  CanFrame disable() noexcept override { return encode({toy::kOff, {}}); }
  CanFrame clear_error() noexcept override { return encode({toy::kFailed, {}}); }
  CanFrame enable(const DriveMemory& /*memory*/) noexcept override {
    return encode({toy::kOn, {}});
  }
  CanFrame state_request() const noexcept override { return encode({toy::kRequest, {}}); }
  bool is_mine(const CanFrame& frame) const noexcept override {
    return has_id(frame, drive_.reply_id);
  }
  StateReading read_state(const CanFrame& frame, bool /*late*/,
                          DriveReport* report) noexcept override {
    toy::State state;
    if (!toy::decode(frame, drive_.reply_id, &state)) return StateReading::kNone;
    report->condition = state.mode == toy::kOn    ? DriveCondition::kEnabled
                        : state.mode == toy::kOff ? DriveCondition::kDisabled
                                                  : DriveCondition::kFailed;
    report->status = state.mode;
    report->angle_rad = report->link_angle_rad = state.values[0];
    report->speed_rad_per_s = report->link_speed_rad_per_s = state.values[1];
    report->torque_Nm = state.values[2];
    return StateReading::kWhole;
  }
  double angle_resolution() const noexcept override {
    return std::numeric_limits<float>::epsilon();
  }
  std::vector<CanFilter> receive_filters() const override {
    return {exactly(drive_.command_id), exactly(drive_.reply_id)};
  }

 private:
  CanFrame encode(const toy::Command& command) const noexcept {
    return toy::encode(command, drive_.command_id);
  }
  DriveConfig drive_;
  double most_;
};

/// Nothing is set in these drives.
class ToyStartup final : public StartupDialogue {
 public:
  explicit ToyStartup(const DriveConfig& drive) : drive_(drive) {}
  CanFrame presence_request() const noexcept override {
    return toy::encode(toy::Command{toy::kRequest, {}}, drive_.command_id);
  }
  bool is_presence(const CanFrame& frame) const noexcept override {
    return has_id(frame, drive_.reply_id);
  }
  int steps() const noexcept override { return 0; }
  StartupStep step(int /*index*/) const noexcept override { return {}; }
  CanFrame request(int /*index*/) const noexcept override { return {}; }
  Answer check_answer(int /*index*/, const CanFrame& /*frame*/,
                      double* /*found*/) noexcept override {
    return Answer::kNone;
  }

 private:
  DriveConfig drive_;
};

class ToyIntruders final : public IntruderRules {
 public:
  explicit ToyIntruders(const DriveConfig& drive) : drive_(drive) {}
  bool is_foreign_command(const CanFrame& frame) const noexcept override {
    return has_id(frame, drive_.command_id);
  }

 private:
  DriveConfig drive_;
};

}  // namespace

std::unique_ptr<DriveCodec> toy_codec(const JointConfig& joint) {
  return std::make_unique<ToyCodec>(joint);
}
std::unique_ptr<StartupDialogue> toy_startup(const JointConfig& joint) {
  return std::make_unique<ToyStartup>(joint.drive);
}
std::unique_ptr<IntruderRules> toy_intruders(const JointConfig& joint) {
  return std::make_unique<ToyIntruders>(joint.drive);
}

}  // namespace limber
