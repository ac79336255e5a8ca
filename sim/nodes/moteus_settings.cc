#include "sim/nodes/moteus_settings.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "drivers/protocols/moteus_registers.h"

namespace limber::sim {
namespace {

constexpr double kStopped = static_cast<double>(moteus::Mode::kStopped);
constexpr double kZeroVelocity = static_cast<double>(moteus::Mode::kZeroVelocity);

bool is_id(double value) { return value >= 1.0 && value <= 126.0 && value == std::floor(value); }
bool never(double /*value*/) { return false; }
bool is_zero(double value) { return value == 0.0; }
bool is_positive(double value) { return value > 0.0 && std::isfinite(value); }
bool is_positive_or_none(double value) { return std::isnan(value) || is_positive(value); }
bool is_number_or_none(double value) { return !std::isinf(value); }
bool is_reaction(double value) { return value == kStopped || value == kZeroVelocity; }

struct SettingRow {
  std::string_view name;
  bool whole;
  bool (*takes)(double);
};

// In the order of Setting.
constexpr std::array kSettingRows = {
    SettingRow{"id.id", true, is_id},
    SettingRow{"motor_position.rotor_to_output_ratio", false, never},
    SettingRow{"servo.pid_position.kp", false, is_positive},
    SettingRow{"servo.pid_position.ki", false, is_zero},
    SettingRow{"servo.pid_position.kd", false, is_positive},
    SettingRow{"servo.default_timeout_s", false, is_positive_or_none},
    SettingRow{"servo.timeout_mode", true, is_reaction},
    SettingRow{"servo.timeout_max_torque_Nm", false, is_positive},
    SettingRow{"servo.default_velocity_limit", false, is_positive_or_none},
    SettingRow{"servo.default_accel_limit", false, is_positive_or_none},
    SettingRow{"servo.fault_temperature", false, never},
    SettingRow{"servopos.position_min", false, is_number_or_none},
    SettingRow{"servopos.position_max", false, is_number_or_none},
};
static_assert(kSettingRows.size() == static_cast<std::size_t>(Setting::kCount));

std::string_view group_of(std::string_view name) noexcept { return name.substr(0, name.find('.')); }

bool is_group(std::string_view word) noexcept {
  for (const SettingRow& row : kSettingRows) {
    if (group_of(row.name) == word) return true;
  }
  return false;
}

std::size_t row_of(std::string_view name) noexcept {
  std::size_t i = 0;
  while (i < kSettingRows.size() && kSettingRows[i].name != name) ++i;
  return i;
}

}  // namespace

MoteusSettings::MoteusSettings(const DriveConfig& drive, std::uint8_t id) {
  constexpr double kRevolution_rad = 2.0 * std::numbers::pi;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  constexpr double kDefaultTimeout_s = 0.1;
  constexpr double kFaultTemperature_degC = 75.0;
  const bool damps = drive.watchdog_reaction == NodeWatchdogReaction::kDamp;
  default_ = {static_cast<double>(id),
              1.0 / drive.gear_ratio,
              drive.range.kp_Nm_per_rad * kRevolution_rad,
              0.0,
              drive.range.kd_Nms_per_rad * kRevolution_rad,
              kDefaultTimeout_s,
              damps ? kZeroVelocity : kStopped,
              drive.timeout_torque_Nm,
              kNone,
              kNone,
              kFaultTemperature_degC,
              kNone,
              kNone};
  stored_ = values_ = default_;
}

void MoteusSettings::command(std::string_view words, MoteusText* text) noexcept {
  const std::string_view verb = next_word(&words);
  if (verb == "get") return get(words, text);
  if (verb == "set") return set(words, text);
  if (verb == "enumerate") return enumerate(words, text);
  if (verb == "write") {
    stored_ = values_;
  } else if (verb == "load") {
    values_ = stored_;
  } else if (verb == "default") {
    values_ = default_;
  } else {
    return text->error("unknown subcommand");
  }
  text->ok();
}

void MoteusSettings::enumerate(std::string_view group, MoteusText* text) const noexcept {
  if (!group.empty() && !is_group(group)) return text->error("unknown group");
  for (std::size_t i = 0; i < kCount; ++i) {
    const SettingRow& row = kSettingRows[i];
    if (!group.empty() && group_of(row.name) != group) continue;
    text->write(row.name);
    text->write_value(" ", values_[i], row.whole, "\r\n");
  }
  text->ok();
}

void MoteusSettings::get(std::string_view name, MoteusText* text) const noexcept {
  if (!is_group(group_of(name))) return text->error("unknown group");
  const std::size_t i = row_of(name);
  if (i == kCount) return text->error("error reading");
  text->write_value("", values_[i], kSettingRows[i].whole, "\r\n");
}

void MoteusSettings::set(std::string_view words, MoteusText* text) noexcept {
  const std::string_view name = next_word(&words);
  if (!is_group(group_of(name))) return text->error("unknown group");
  const std::size_t i = row_of(name);
  double value = 0.0;
  if (i == kCount || !parse_number(words, &value) || !kSettingRows[i].takes(value))
    return text->error("error setting");
  values_[i] = value;
  text->ok();
}

}  // namespace limber::sim
