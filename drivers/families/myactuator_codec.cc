// Commands and states of MyActuator drives. There is no enabling: a drive obeys the first motion
// command, and its answer tells neither an error nor whether it was obeyed. So the codec keeps what
// the drive was told and what it told: a drive is on once it has answered that its brake is
// released, and off once it has answered that.
#include <algorithm>
#include <array>
#include <utility>

#include "drivers/families/mit_commands.h"
#include "drivers/families/myactuator_family.h"
#include "drivers/protocols/myactuator.h"

namespace limber {
namespace {

using myactuator::Order;

constexpr int kMotionAngleBits = 16;
constexpr int kMotionBits = 12;
constexpr int kMostCycles = 1000;
// Of DriveReport::status, beside the errors.
constexpr std::uint16_t kLetGo = 0x0001;
constexpr std::uint16_t kRuns = 0x8000;

class MyactuatorCodec final : public DriveCodec {
 public:
  MyactuatorCodec(const JointConfig& joint, double period_s)
      : drive_(joint.drive),
        number_(myactuator_number(joint.drive)),
        period_s_(period_s),
        commands_(joint, drive_.command_id, false) {}

  /// None to a drive in error, nor to one that let go: it would obey the second.
  bool command(const DriveCommand& command, const DriveMemory& /*memory*/, CanFrame* frame,
               DriveCommand* sent) noexcept override {
    if (failed() || !commands_.encode(command, frame, sent)) return false;
    std::copy_n(frame->data.begin(), sent_.size(), sent_.begin());
    acts_ = true;
    return true;
  }
  CanFrame disable() noexcept override {
    commands_.start_afresh();
    return state_request();
  }
  /// Nothing clears an error: one goes with its cause, or when the drive is reset.
  CanFrame clear_error() noexcept override {
    let_go_ = false;
    return acts_ ? state_request() : myactuator::order_frame(Order::kStatus, number_);
  }
  /// The brake may take its time; commands without torque are answered meanwhile.
  CanFrame enable(const DriveMemory& memory) noexcept override {
    CanFrame frame;
    DriveCommand sent;
    releasing_ = !releasing_;
    if (releasing_) return myactuator::order_frame(Order::kReleaseBrake, number_);
    return command({.angle_rad = memory.seen.angle_rad}, memory, &frame, &sent) ? frame
                                                                                : state_request();
  }
  /// Off, until that is answered; then its angle, and in the next cycle its errors.
  CanFrame state_request() const noexcept override {
    return myactuator::order_frame(acts_    ? Order::kOff
                                   : angle_ ? Order::kAngle
                                            : Order::kStatus,
                                   number_);
  }

  void begin_cycle() noexcept override {
    angle_ = !angle_;
    age_cycles_ = std::min(age_cycles_ + 1, kMostCycles);
  }
  bool is_mine(const CanFrame& frame) const noexcept override {
    return has_id(frame, drive_.reply_id) || has_id(frame, answer_id());
  }
  /// Half a count is added to the fields, because drives truncate.
  StateReading read_state(const CanFrame& frame, bool late, DriveReport* report) noexcept override;
  /// A time-out, an error, or the answer to another order than that of the cycle.
  bool is_unsolicited(const CanFrame& frame) const noexcept override {
    return std::ranges::any_of(
        std::array{Order::kTimedOut, Order::kStatus, Order::kReleaseBrake, Order::kOff},
        [&](Order order) { return myactuator::answers(frame, order, number_); });
  }
  void record_unsolicited(const CanFrame& frame) noexcept override {
    static_cast<void>(take_answer(frame));
  }
  std::string status_text(std::uint16_t status) const override;
  double angle_resolution() const noexcept override {
    return 2.0 * mit::half_count(drive_.range.position_rad, kMotionAngleBits);
  }
  std::vector<CanFilter> receive_filters() const override {
    const auto number = static_cast<std::uint32_t>(number_);
    return {exactly(drive_.reply_id),           exactly(answer_id()),
            exactly(drive_.command_id),         exactly(myactuator::kOrderId + number),
            exactly(myactuator::kEveryMotorId), exactly(myactuator::kSetNumberId)};
  }

 private:
  std::uint32_t answer_id() const noexcept {
    return myactuator::kAnswerId + static_cast<std::uint32_t>(number_);
  }
  bool failed() const noexcept { return let_go_ || errors_ != 0; }
  void let_go() noexcept {
    let_go_ = let_go_ || acts_;
    released_ = false;
  }
  bool take_answer(const CanFrame& frame) noexcept;
  StateReading whole(DriveReport* report) const noexcept;

  DriveConfig drive_;
  int number_;
  double period_s_;
  MitCommands commands_;
  bool acts_ = true;  ///< a motion command may be at work
  std::array<std::uint8_t, 8> sent_{};
  bool releasing_ = false;
  bool released_ = false;
  bool echoes_ = false;  ///< the drive's next answer repeats the request
  bool let_go_ = false;
  std::uint16_t errors_ = 0;
  bool angle_ = true;      ///< is requested next
  bool measured_ = false;  ///< what follows, `age_cycles_` ago
  int age_cycles_ = 0;
  double angle_rad_ = 0.0;
  double speed_rad_per_s_ = 0.0;
  double torque_Nm_ = 0.0;
  double temperature_degC_ = 0.0;
};

/// False if it is none of those that tell the drive's state.
bool MyactuatorCodec::take_answer(const CanFrame& frame) noexcept {
  if (myactuator::answers(frame, Order::kTimedOut, number_)) {
    echoes_ = true;
    let_go();
    return true;
  }
  const bool echo = std::exchange(echoes_, false);
  if (myactuator::answers(frame, Order::kOff, number_)) {
    acts_ = released_ = releasing_ = false;  // after a time-out, too
    torque_Nm_ = 0.0;
    return true;
  }
  if (myactuator::answers(frame, Order::kReleaseBrake, number_)) {
    released_ = !echo;
    return true;
  }
  if (myactuator::answers(frame, Order::kStatus, number_)) {
    if (echo) return true;
    const myactuator::Status status = myactuator::decode_status(frame);
    errors_ = status.errors;
    temperature_degC_ = status.temperature_degC;
    return true;
  }
  if (!myactuator::answers(frame, Order::kAngle, number_)) return false;
  if (echo) return true;
  const double angle_rad = myactuator::decode_angle(frame);
  const double passed_s = period_s_ * std::max(age_cycles_, 1);
  speed_rad_per_s_ = measured_ ? (angle_rad - angle_rad_) / passed_s : 0.0;
  angle_rad_ = angle_rad;
  age_cycles_ = 0;
  measured_ = true;
  return true;
}

StateReading MyactuatorCodec::read_state(const CanFrame& frame, bool /*late*/,
                                         DriveReport* report) noexcept {
  if (acts_ && is_mine(frame) &&
      std::equal(sent_.begin(), sent_.end(),
                 frame.data.begin())) {  // the first command after a time-out
    echoes_ = false;
    let_go();
    return StateReading::kPart;
  }
  const CommandRange& range = drive_.range;
  myactuator::Motion motion;
  if (has_id(frame, drive_.reply_id)) {
    if (!myactuator::decode_motion(frame, range, &motion)) return StateReading::kNone;
    angle_rad_ = motion.position_rad + mit::half_count(range.position_rad, kMotionAngleBits);
    speed_rad_per_s_ =
        motion.velocity_rad_per_s + mit::half_count(range.velocity_rad_per_s, kMotionBits);
    torque_Nm_ = motion.torque_Nm + mit::half_count(range.torque_Nm, kMotionBits);
    age_cycles_ = 0;
    measured_ = true;
    return whole(report);
  }
  if (!take_answer(frame)) return StateReading::kNone;
  // Beside the answers to motion commands the others are no states of their own.
  return acts_ && !myactuator::answers(frame, Order::kReleaseBrake, number_) ? StateReading::kPart
                                                                             : whole(report);
}

StateReading MyactuatorCodec::whole(DriveReport* report) const noexcept {
  if (!measured_) return StateReading::kPart;
  const bool on = acts_ && released_;
  report->condition = failed() ? DriveCondition::kFailed
                      : on     ? DriveCondition::kEnabled
                               : DriveCondition::kDisabled;
  report->status = static_cast<std::uint16_t>(errors_ | (let_go_ ? kLetGo : 0) | (on ? kRuns : 0));
  report->angle_rad = report->link_angle_rad =
      angle_rad_ + speed_rad_per_s_ * period_s_ * age_cycles_;
  report->speed_rad_per_s = report->link_speed_rad_per_s = speed_rad_per_s_;
  report->torque_Nm = torque_Nm_;
  report->current_A = torque_Nm_ / drive_.torque_constant_Nm_per_A;
  report->temperature_degC = temperature_degC_;
  return StateReading::kWhole;
}

std::string MyactuatorCodec::status_text(std::uint16_t status) const {
  const auto errors = static_cast<std::uint16_t>(status & ~(kLetGo | kRuns));
  if (errors != 0) return myactuator::errors_text(errors);
  if ((status & kLetGo) != 0) return "let go: no command within the drive's time-out";
  return (status & kRuns) != 0 ? "running" : "off, without an error";
}

}  // namespace

std::unique_ptr<DriveCodec> myactuator_codec(const JointConfig& joint, double period_s) {
  return std::make_unique<MyactuatorCodec>(joint, period_s);
}

}  // namespace limber
