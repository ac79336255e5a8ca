// Commands and states of ODrive drives. Estimates, errors and torques are asked for in each cycle;
// whether the axis is in closed loop tells its heartbeat alone, every 0.1 s, and sooner a torque
// that stays at zero.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "drivers/families/odrive_family.h"

namespace limber {
namespace {

using odrive::Message;

class OdriveCodec final : public DriveCodec {
 public:
  OdriveCodec(const JointConfig& joint, double period_s)
      : drive_(joint.drive),
        node_(odrive_node(drive_)),
        most_torque_(std::min(joint.torque_limit_Nm, drive_.peak_torque_Nm)),
        enabling_cycles_(static_cast<int>(std::ceil(kEnabling_s / period_s))),
        requests_{odrive::ask(node_, Message::kEstimates), odrive::ask(node_, Message::kError),
                  odrive::ask(node_, Message::kTorques)} {}

  /// The drive has no gains: their torque is computed here, of the state of the cycle before, and
  /// left out if that is too old.
  bool command(const DriveCommand& command, const DriveMemory& memory, CanFrame* frame,
               DriveCommand* sent) noexcept override;
  CanFrame disable() noexcept override {
    forget();
    return odrive::encode(node_, Message::kSetState, odrive::kIdle);
  }
  CanFrame clear_error() noexcept override {
    forget();
    return odrive::encode(node_, Message::kClearErrors);
  }
  /// A repeated request would start the closed loop afresh: not before a heartbeat can have come.
  CanFrame enable(const DriveMemory& memory) noexcept override;
  CanFrame state_request() const noexcept override { return requests_[0]; }
  std::span<const CanFrame> part_requests() const noexcept override { return requests_; }

  void begin_cycle() noexcept override {
    enabling_ = std::max(enabling_ - 1, 0);
    parts_[1] = parts_[0];
    parts_[0].taken = 0;
  }
  bool is_mine(const CanFrame& frame) const noexcept override {
    const odrive::Layout* layout = odrive::layout_of(frame.id);
    return layout != nullptr && layout->from_drive &&
           odrive::is_message(frame, node_, layout->message, 0);
  }
  StateReading read_state(const CanFrame& frame, bool late, DriveReport* report) noexcept override;
  /// Until the start-up has switched them off, estimates come by themselves, too.
  bool is_unsolicited(const CanFrame& frame) const noexcept override {
    const std::size_t part = part_of(frame);
    return is_mine(frame) &&
           (part == requests_.size() || (part == 0 && state_ != odrive::kClosedLoop));
  }
  void record_unsolicited(const CanFrame& frame) noexcept override {
    if (!odrive::is_message(frame, node_, Message::kHeartbeat, 6)) return;
    state_ = frame.data[4];
    result_ = frame.data[5];
  }
  std::string status_text(std::uint16_t status) const override;
  double angle_resolution() const noexcept override {
    return 2.0 * std::numbers::pi / drive_.counts_per_turn;
  }
  std::vector<CanFilter> receive_filters() const override {
    constexpr std::uint32_t kNode = 0x7E0;
    return {{node_ << 5U, kNode, false}, {odrive::kEverybody << 5U, kNode, false}};
  }

 private:
  static constexpr double kEnabling_s = 0.15;  // the heartbeat comes every 0.1 s
  // Of the greatest torque: what a drive may read that makes none, and what is clearly more.
  static constexpr double kIdleShare = 0.01;
  static constexpr double kClearShare = 0.05;
  static constexpr int kIdleReplies = 10;
  static constexpr std::uint16_t kLetGo = 0x8000;  // of DriveReport::status

  struct Parts {
    unsigned taken = 0;  ///< bits, in the order of the requests
    float turns = 0.0F;
    float turns_per_s = 0.0F;
    std::uint32_t errors = 0;
    float torque_Nm = 0.0F;
  };
  /// Of the requests; their number if it is none.
  std::size_t part_of(const CanFrame& frame) const noexcept {
    std::size_t part = 0;
    while (part < requests_.size() && requests_[part].id != frame.id) ++part;
    return part;
  }
  /// Nothing of before counts; the next heartbeat tells.
  void forget() noexcept {
    state_ = result_ = 0;
    idle_replies_ = enabling_ = 0;
    sent_Nm_ = 0.0;
  }
  void finish(const Parts& parts, DriveReport* report) noexcept;

  DriveConfig drive_;
  std::uint32_t node_;
  double most_torque_;
  int enabling_cycles_;
  std::array<CanFrame, 3> requests_;
  std::array<Parts, 2> parts_;  ///< of this cycle, and of the one before
  std::uint8_t state_ = 0;      ///< by the last heartbeat
  std::uint8_t result_ = 0;
  int enabling_ = 0;  ///< cycles that a heartbeat may still take
  int idle_replies_ = 0;
  double sent_Nm_ = 0.0;
};

bool OdriveCodec::command(const DriveCommand& command, const DriveMemory& memory, CanFrame* frame,
                          DriveCommand* sent) noexcept {
  const DriveReport& seen = memory.seen;
  double tau = command.torque_Nm;
  if (memory.recent)
    tau += command.kp_Nm_per_rad * (command.angle_rad - seen.angle_rad) +
           command.kd_Nms_per_rad * (command.speed_rad_per_s - seen.speed_rad_per_s);
  if (!all_finite(command) || !std::isfinite(tau)) return false;
  sent_Nm_ = std::clamp(tau, -most_torque_, most_torque_);
  *frame =
      odrive::encode(node_, Message::kTorque, static_cast<float>(sent_Nm_ / drive_.gear_ratio));
  *sent = {command.angle_rad, command.speed_rad_per_s, 0.0, 0.0, sent_Nm_};
  return true;
}

CanFrame OdriveCodec::enable(const DriveMemory& /*memory*/) noexcept {
  if (enabling_ > 0) return state_request();
  forget();
  enabling_ = enabling_cycles_;
  return odrive::encode(node_, Message::kSetState, odrive::kClosedLoop);
}

StateReading OdriveCodec::read_state(const CanFrame& frame, bool late,
                                     DriveReport* report) noexcept {
  const std::size_t part = part_of(frame);
  Parts& parts = parts_[late ? 1 : 0];
  if (part == requests_.size() || (parts.taken >> part & 1U) != 0 || !is_mine(frame) ||
      frame.length < 8)
    return StateReading::kNone;
  const auto first = odrive::field<float>(frame, 0);
  const auto second = odrive::field<float>(frame, 4);
  if (part != 1 && !(std::isfinite(first) && std::isfinite(second))) return StateReading::kNone;
  if (part == 0) {
    parts.turns = first;
    parts.turns_per_s = second;
  } else if (part == 1) {
    parts.errors = odrive::field<std::uint32_t>(frame, 0) | odrive::field<std::uint32_t>(frame, 4);
  } else {
    parts.torque_Nm = second;
  }
  parts.taken |= 1U << part;
  if (parts.taken != 0b111) return StateReading::kPart;
  finish(parts, report);
  return StateReading::kWhole;
}

void OdriveCodec::finish(const Parts& parts, DriveReport* report) noexcept {
  const double turns_per_rad = odrive_turns_per_rad(drive_);
  report->angle_rad = report->link_angle_rad = parts.turns / turns_per_rad;
  report->speed_rad_per_s = report->link_speed_rad_per_s = parts.turns_per_s / turns_per_rad;
  report->torque_Nm = parts.torque_Nm * drive_.gear_ratio;
  report->current_A = report->torque_Nm / drive_.torque_constant_Nm_per_A;
  const bool runs = state_ == odrive::kClosedLoop;
  const bool idle = runs && std::abs(report->torque_Nm) < kIdleShare * most_torque_ &&
                    std::abs(sent_Nm_) > kClearShare * most_torque_;
  idle_replies_ = idle ? std::min(idle_replies_ + 1, kIdleReplies) : 0;
  const bool let_go = idle_replies_ == kIdleReplies;
  report->condition = parts.errors != 0 || let_go ? DriveCondition::kFailed
                      : runs                      ? DriveCondition::kEnabled
                                                  : DriveCondition::kDisabled;
  const int error = parts.errors == 0 ? 0 : std::countr_zero(parts.errors) + 1;
  report->status =
      static_cast<std::uint16_t>((state_ & 0xFU) | (result_ & 0xFU) << 4U |
                                 static_cast<unsigned>(error) << 8U | (let_go ? kLetGo : 0U));
}

std::string OdriveCodec::status_text(std::uint16_t status) const {
  if (const unsigned error = status >> 8U & 0x3FU; error != 0)
    return "error: " + odrive::error_text(1U << (error - 1U));
  if ((status & kLetGo) != 0) return "makes no torque: switched off or reset";
  const unsigned result = status >> 4U & 0xFU;
  return odrive::state_text(status & 0xFU) + (result == odrive::kNotCalibrated ? ": not calibrated"
                                              : result > 2U
                                                  ? fmt::format(", procedure result {}", result)
                                                  : "");
}

}  // namespace

std::unique_ptr<DriveCodec> odrive_codec(const JointConfig& joint, double period_s) {
  return std::make_unique<OdriveCodec>(joint, period_s);
}

}  // namespace limber
