#include "drivers/families/moteus_family.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

#include "robots/loader/protocols/drive_protocol.h"

namespace limber {
namespace {

using moteus::Mode;
using moteus::Register;

constexpr double kTurn = 2.0 * std::numbers::pi;  // rad
constexpr double kHomedRotor = 1.0;
constexpr double kHomedOutput = 2.0;
/// Numbers of the questions, beyond those of registers.
constexpr std::uint32_t kFirstQuestion = 0x10000;
constexpr std::string_view kGet = "conf get ";
/// Numbers come with six decimals.
constexpr double kLastDecimal = 1e-6;

bool equal(double found, double expected) {
  return std::abs(found - expected) <= 1e-4 * std::abs(expected) + kLastDecimal;
}
/// A limit in the drive; NaN is none, on either side.
bool not_above(double found, double expected) {
  return std::isnan(found) || found <= expected + kLastDecimal;
}
bool not_below(double found, double expected) {
  return std::isnan(found) || found >= expected - kLastDecimal;
}

/// NaN is none here, too.
bool above(double found, double limit) { return !(found <= limit); }

DriveCondition condition_of(Mode mode) noexcept {
  switch (mode) {
    case Mode::kPosition:
      return DriveCondition::kEnabled;
    case Mode::kStopped:
    case Mode::kEnabling:
    case Mode::kCalibrating:
    case Mode::kCalibrationComplete:
      return DriveCondition::kDisabled;
    default:  // faults, time-out, and modes that somebody else has chosen
      return DriveCondition::kFailed;
  }
}

/// Registers have hexadecimal numbers in the maker's reference.
std::string describe_register(const StartupFailure& failure) {
  if (failure.reg == 0) return "could not be stopped, or does not answer";
  const bool map = failure.reg == static_cast<std::uint32_t>(Register::kRegisterMap);
  const std::string name =
      fmt::format("{} (register {:03X}h)", map ? "register map" : "home state", failure.reg);
  if (failure.answer == Answer::kNone) return name + " not answered";
  return fmt::format("{} is {:g}, expected {:g}", name, failure.found, failure.expected);
}

}  // namespace

MoteusFamily::MoteusFamily(const JointConfig& joint)
    : drive_(joint.drive),
      torque_limit_(std::min(joint.torque_limit_Nm, joint.drive.range.torque_Nm)) {
  const auto turns = [this](double angle_rad) {
    return (drive_.sign * angle_rad + drive_.offset_rad) / kTurn;
  };
  const double a = turns(joint.position_min);
  const double b = turns(joint.position_max);
  questions_ = {{
      {"tel stop", nullptr, 0.0},
      {"conf get servo.pid_position.kp", equal, drive_.range.kp_Nm_per_rad * kTurn},
      {"conf get servo.pid_position.ki", equal, 0.0},  // would act on torque commands, too
      {"conf get servo.pid_position.kd", equal, drive_.range.kd_Nms_per_rad * kTurn},
      {"conf get servopos.position_min", not_above, std::min(a, b)},
      {"conf get servopos.position_max", not_below, std::max(a, b)},
      {"conf get servo.fault_temperature", above, drive_.limit_temperature_degC},
  }};
}

bool MoteusFamily::command(const DriveCommand& command, const DriveMemory& /*memory*/,
                           CanFrame* frame, DriveCommand* sent) noexcept {
  if (!all_finite(command)) return false;
  const CommandRange& range = drive_.range;
  const double kd_scale = std::clamp(command.kd_Nms_per_rad / range.kd_Nms_per_rad, 0.0, 1.0);
  const double kp_scale = std::clamp(command.kp_Nm_per_rad / range.kp_Nm_per_rad, 0.0, 1.0);
  *sent = {command.angle_rad, command.speed_rad_per_s, kp_scale * range.kp_Nm_per_rad,
           kd_scale * range.kd_Nms_per_rad,
           std::clamp(command.torque_Nm, -torque_limit_, torque_limit_)};
  moteus::Command out;
  out.position_turns =
      kp_scale > 0.0 ? command.angle_rad / kTurn : std::numeric_limits<double>::quiet_NaN();
  out.velocity_turns_per_s = command.speed_rad_per_s / kTurn;
  out.torque_Nm = sent->torque_Nm;
  out.kp_scale = kp_scale;
  out.kd_scale = kd_scale;
  out.max_torque_Nm = torque_limit_;
  out.watchdog_s = drive_.watchdog_s;
  *frame = moteus::encode_command(out, drive_.command_id);
  return true;
}

CanFrame MoteusFamily::enable(const DriveMemory& memory) noexcept {
  CanFrame frame;
  DriveCommand sent;
  const DriveCommand nothing{memory.seen.angle_rad, 0.0, 0.0, 0.0, 0.0};
  return command(nothing, memory, &frame, &sent) ? frame : state_request();
}

bool MoteusFamily::is_foreign_command(const CanFrame& frame) const noexcept {
  // Bits 16 to 28 are the prefix, which must be the drive's; a reply is for host 0.
  const bool prefix = frame.id >> 16U == drive_.command_id >> 16U;
  return !frame.error && prefix && accepts_id(drive_, frame.id);
}

// The last seven bits are the number of whom a frame is for, 7Fh all; its prefix is the drive's.
std::vector<CanFilter> MoteusFamily::receive_filters() const {
  constexpr std::uint32_t kNumber = 0x7F;
  constexpr std::uint32_t kPrefix = 0x1FFF0000;
  std::vector<CanFilter> filters = {exactly(drive_.reply_id)};
  for (std::uint32_t number : {drive_.command_id & kNumber, kNumber}) {
    filters.push_back({number, kNumber, false});
    filters.push_back({(drive_.command_id & kPrefix) | number, kPrefix | kNumber, true});
  }
  return filters;
}

StateReading MoteusFamily::read_state(const CanFrame& frame, bool /*late*/,
                                      DriveReport* report) noexcept {
  moteus::State state;
  if (!moteus::decode_state(frame, &state)) return StateReading::kNone;
  report->condition = condition_of(state.mode);
  report->status =
      static_cast<std::uint16_t>(static_cast<int>(state.mode) | (state.fault & 0xFF) << 8);
  report->angle_rad = report->link_angle_rad = state.position_turns * kTurn;
  report->speed_rad_per_s = report->link_speed_rad_per_s = state.velocity_turns_per_s * kTurn;
  report->torque_Nm = state.torque_Nm;
  report->current_A = state.current_q_A;
  report->temperature_degC = state.temperature_degC;
  return StateReading::kWhole;
}

std::string MoteusFamily::status_text(std::uint16_t status) const {
  const int mode = status & 0xFF;
  const int fault = status >> 8;
  if (mode == static_cast<int>(moteus::Mode::kTimeout))
    return "mode 11: no command within the drive's time-out";
  if (fault == 0) return fmt::format("mode {}: {}", mode, moteus::mode_text(mode));
  const std::string_view text = moteus::fault_text(fault);
  return fmt::format("mode {}, fault {}: {}", mode, fault,
                     text.empty() ? "see the maker's list" : text);
}

double MoteusFamily::angle_resolution() const noexcept {
  const double encoder = kTurn / drive_.counts_per_turn;
  return std::max(encoder, kTurn * static_cast<double>(std::numeric_limits<float>::epsilon()));
}

StartupStep MoteusFamily::startup_step(int index) const noexcept {
  if (index >= kRegisters) {
    const int question = question_of(index);
    return {kFirstQuestion + static_cast<std::uint32_t>(question),
            questions_[static_cast<std::size_t>(question)].expected};
  }
  if (index == 0)
    return {static_cast<std::uint32_t>(Register::kRegisterMap), moteus::kRegisterMapVersion};
  // Behind a gear, a drive that has only its rotor's angle may be off by a rotor turn.
  return {static_cast<std::uint32_t>(Register::kHomeState),
          drive_.gear_ratio == 1.0 ? kHomedRotor : kHomedOutput};
}

CanFrame MoteusFamily::startup_request(int index) const noexcept {
  if (index < kRegisters)
    return moteus::encode_read(static_cast<Register>(startup_step(index).reg), drive_.command_id);
  const auto question = static_cast<std::size_t>(question_of(index));
  const bool answers = (index - kRegisters) % 2 == 1;
  return answers ? moteus::encode_text_poll(drive_.command_id)
                 : moteus::encode_line(questions_[question].line, drive_.command_id);
}

Answer MoteusFamily::check_answer(int index, const CanFrame& frame, double* found) noexcept {
  if (index < kRegisters) return check_register(index, frame, found);
  std::string_view text;
  const bool speaks = moteus::decode_text(frame, &text);
  moteus::State state;
  if (!speaks && moteus::decode_state(frame, &state)) return Answer::kNone;
  *found = 0.0;
  if (!speaks) {
    const Answer answer = speaks_ ? Answer::kMissing : Answer::kRight;  // one warning is enough
    speaks_ = false;
    return answer;
  }
  speaks_ = true;
  const bool sent = (index - kRegisters) % 2 == 0;
  if (sent) {  // the text is what the drive had to say before
    line_size_ = 0;
    return Answer::kRight;
  }
  return check_line(questions_[static_cast<std::size_t>(question_of(index))], text, found);
}

Answer MoteusFamily::check_register(int index, const CanFrame& frame,
                                    double* found) const noexcept {
  const StartupStep step = startup_step(index);
  if (!moteus::decode_register(frame, static_cast<Register>(step.reg), found)) return Answer::kNone;
  const bool right =
      index == 0 ? *found == step.expected : *found >= step.expected && *found <= kHomedOutput;
  return right ? Answer::kRight : Answer::kWrong;
}

/// The answer's line may come in pieces, and other lines before it.
Answer MoteusFamily::check_line(const Question& question, std::string_view text,
                                double* found) noexcept {
  for (const char letter : text) {
    if (letter != '\r' && letter != '\n') {
      if (line_size_ == line_.size()) line_size_ = 0;
      line_[line_size_++] = letter;
      continue;
    }
    const std::string_view line(line_.data(), line_size_);
    line_size_ = 0;
    if (question.right == nullptr) {
      if (line.ends_with("OK")) return Answer::kRight;
      continue;
    }
    if (line.starts_with("ERR")) return Answer::kMissing;
    const char* end = line.data() + line.size();
    if (line.empty() || std::from_chars(line.data(), end, *found).ptr != end) continue;
    return question.right(*found, question.expected) ? Answer::kRight : Answer::kWrong;
  }
  return Answer::kNotYet;
}

std::string MoteusFamily::describe(const StartupFailure& failure) const {
  if (failure.reg < kFirstQuestion) return describe_register(failure);
  std::string_view name = questions_[failure.reg - kFirstQuestion].line;
  if (name.starts_with(kGet)) name.remove_prefix(kGet.size());
  if (failure.answer == Answer::kMissing && failure.reg == kFirstQuestion)
    return "no diagnostic channel: servo.pid_position and servopos are not compared with "
           "robot.yaml";
  if (failure.answer == Answer::kMissing)
    return fmt::format("{} cannot be read, and is not compared with robot.yaml", name);
  if (failure.answer != Answer::kWrong)
    return fmt::format("{} not answered over the diagnostic channel", name);
  if (name == "servo.fault_temperature")
    return fmt::format(
        "{} is {:g}, expected more than {:g}: the drive would let go before "
        "limit_temperature_degC stops the arm",
        name, failure.found, failure.expected);
  if (std::isinf(failure.expected))
    return fmt::format("{} is {:g}, expected nan: the joint has no end", name, failure.found);
  return fmt::format("{} is {:g}, expected {:g}{}", name, failure.found, failure.expected,
                     name.starts_with("servopos") ? " or beyond" : "");
}

}  // namespace limber
