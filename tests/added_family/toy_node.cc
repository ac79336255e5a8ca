#include "tests/added_family/toy.h"

namespace limber::sim {
namespace {

class ToyNode final : public MotorNode {
 public:
  explicit ToyNode(const JointConfig& joint) : drive_(joint.drive) {}

  bool receive(const CanFrame& frame, const JointReading& joint, std::int64_t now_ns,
               CanFrame* reply) noexcept override {
    now_ns_ = now_ns;
    toy::Command command;
    if (!toy::decode(frame, drive_.command_id, &command)) return false;
    const auto f = [&](double value) { return static_cast<float>(drive_.sign * value); };
    *reply = toy::encode(
        toy::State{mode_,
                   {frozen() ? frozen_ : f(joint.theta) + static_cast<float>(drive_.offset_rad),
                    frozen() ? 0.0F : f(joint.theta_dot), f(joint.motor_torque)}},
        drive_.reply_id);
    if (!has(scenario_event_t::FAULT_DROP_COMMANDS)) obey(command, now_ns);
    return !has(scenario_event_t::FAULT_SILENT);
  }
  void update(const JointReading& /*joint*/, std::int64_t now_ns) noexcept override {
    now_ns_ = now_ns;
    const double silent_s = static_cast<double>(now_ns - command_ns_) * 1e-9;
    if (mode_ == toy::kOn && silent_s > drive_.watchdog_s) mode_ = toy::kFailed;
  }
  DriveLaw law() const noexcept override {
    if (mode_ != toy::kOn) return {};
    const auto& [angle, speed, kp, kd, torque] = command_.values;
    return {kp,
            kd,
            drive_.sign * (angle - drive_.offset_rad),
            drive_.sign * speed,
            drive_.sign * torque,
            drive_.peak_torque_Nm};
  }
  bool enabled() const noexcept override { return mode_ == toy::kOn; }

 private:
  bool frozen() const noexcept { return has(scenario_event_t::FAULT_FROZEN_ENCODER); }
  void obey(const toy::Command& command, std::int64_t now_ns) noexcept {
    command_ns_ = now_ns;
    if (command.mode == toy::kRequest) return;
    command_ = command;
    if (mode_ == toy::kFailed) {
      const bool stays = has(scenario_event_t::FAULT_DRIVE_ERROR);
      mode_ = command.mode == toy::kFailed && !stays ? toy::kOff : toy::kFailed;
    } else {
      mode_ = command.mode == toy::kOn ? toy::kOn : toy::kOff;
    }
  }
  void on_fault(int fault, const JointReading& joint) noexcept override {
    if (fault == scenario_event_t::FAULT_FROZEN_ENCODER)
      frozen_ = static_cast<float>(drive_.sign * joint.theta + drive_.offset_rad);
    if (fault == scenario_event_t::FAULT_DRIVE_ERROR) mode_ = toy::kFailed;
  }

  DriveConfig drive_;
  toy::Mode mode_ = toy::kOff;
  toy::Command command_;
  float frozen_ = 0.0F;
  std::int64_t command_ns_ = 0;
};

}  // namespace

std::unique_ptr<MotorNode> make_toy_node(const JointConfig& joint) {
  return std::make_unique<ToyNode>(joint);
}

}  // namespace limber::sim
