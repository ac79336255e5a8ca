// Commands and states of Damiao drives.
#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "drivers/families/damiao_family.h"
#include "drivers/families/mit_commands.h"
#include "drivers/protocols/mit.h"

namespace limber {
namespace {

constexpr int kPositionBits = 16;
constexpr int kBits = 12;

DriveCondition condition_of(mit::DriveError status) noexcept {
  switch (status) {
    case mit::DriveError::kEnabled:
      return DriveCondition::kEnabled;
    case mit::DriveError::kDisabled:
      return DriveCondition::kDisabled;
    default:
      return DriveCondition::kFailed;
  }
}

const char* remedy(mit::DriveError error) noexcept {
  switch (error) {
    case mit::DriveError::kOverVoltage:
    case mit::DriveError::kUnderVoltage:
      return "; check the supply";
    case mit::DriveError::kMosOverTemperature:
    case mit::DriveError::kRotorOverTemperature:
      return "; let it cool";
    default:
      return "";
  }
}

class DamiaoCodec final : public DriveCodec {
 public:
  DamiaoCodec(const JointConfig& joint, bool fd)
      : drive_(joint.drive), fd_(fd), commands_(joint, drive_.command_id, fd) {}

  bool command(const DriveCommand& command, const DriveMemory& /*memory*/, CanFrame* frame,
               DriveCommand* sent) noexcept override {
    return commands_.encode(command, frame, sent);
  }
  CanFrame disable() noexcept override { return special(mit::Special::kDisable); }
  CanFrame clear_error() noexcept override { return special(mit::Special::kClearError); }
  CanFrame enable(const DriveMemory& /*memory*/) noexcept override {
    return special(mit::Special::kEnable);
  }
  CanFrame state_request() const noexcept override;

  bool is_mine(const CanFrame& frame) const noexcept override {
    return has_id(frame, drive_.reply_id);
  }
  /// Half a count is added to the fields, because drives truncate.
  StateReading read_state(const CanFrame& frame, bool late, DriveReport* report) noexcept override;
  std::string status_text(std::uint16_t status) const override;
  double angle_resolution() const noexcept override;
  std::vector<CanFilter> receive_filters() const override;

 private:
  CanFrame special(mit::Special special) noexcept;

  DriveConfig drive_;
  bool fd_;
  MitCommands commands_;
};

CanFrame DamiaoCodec::special(mit::Special special) noexcept {
  commands_.start_afresh();
  return mit::encode_special(special, drive_.command_id, fd_);
}

CanFrame DamiaoCodec::state_request() const noexcept {
  return mit::encode_state_request(static_cast<std::uint16_t>(drive_.command_id), fd_);
}

std::vector<CanFilter> DamiaoCodec::receive_filters() const {
  return {exactly(drive_.reply_id), exactly(drive_.command_id), exactly(mit::kRegisterId)};
}

StateReading DamiaoCodec::read_state(const CanFrame& frame, bool /*late*/,
                                     DriveReport* report) noexcept {
  const CommandRange& range = drive_.range;
  mit::Reply reply;
  if (!mit::decode_reply(frame, range, &reply)) return StateReading::kNone;
  if (reply.id_nibble != (drive_.command_id & 0xF)) return StateReading::kNone;
  report->condition = condition_of(reply.error);
  report->status = static_cast<std::uint16_t>(reply.error);
  report->angle_rad = reply.position_rad + mit::half_count(range.position_rad, kPositionBits);
  report->speed_rad_per_s =
      reply.velocity_rad_per_s + mit::half_count(range.velocity_rad_per_s, kBits);
  report->link_angle_rad = report->angle_rad;
  report->link_speed_rad_per_s = report->speed_rad_per_s;
  report->torque_Nm = reply.torque_Nm + mit::half_count(range.torque_Nm, kBits);
  report->current_A = report->torque_Nm / drive_.torque_constant_Nm_per_A;
  report->temperature_degC = std::max(reply.mos_temperature_degC, reply.rotor_temperature_degC);
  return StateReading::kWhole;
}

std::string DamiaoCodec::status_text(std::uint16_t status) const {
  const auto error = static_cast<mit::DriveError>(status);
  if (error == mit::DriveError::kDisabled) return "disabled, without an error";
  if (error == mit::DriveError::kEnabled) return "enabled";
  const std::string_view text = mit::error_text(error);
  return fmt::format("error {:X}: {}{}", status, text.empty() ? "not in the manual" : text,
                     remedy(error));
}

double DamiaoCodec::angle_resolution() const noexcept {
  return 2.0 * mit::half_count(drive_.range.position_rad, kPositionBits);
}

}  // namespace

std::unique_ptr<DriveCodec> damiao_codec(const JointConfig& joint, bool fd) {
  return std::make_unique<DamiaoCodec>(joint, fd);
}

}  // namespace limber
