// Start-up of moteus drives:
//
//   register map version compared -> home state compared -> telemetry stopped
//     -> settings read over the diagnostic channel and compared: kp, kd, ki, position range
//
// The watchdog needs no step: every command carries it.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include "drivers/families/moteus_family.h"
#include "drivers/protocols/moteus.h"

namespace limber {
namespace {

using moteus::kTurn_rad;
using moteus::Register;

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

/// Registers have hexadecimal numbers in the maker's reference.
std::string describe_register(const StartupFailure& failure) {
  if (failure.reg == 0) return "could not be stopped, or does not answer";
  const bool map = failure.reg == static_cast<std::uint32_t>(Register::kRegisterMap);
  const std::string name =
      fmt::format("{} (register {:03X}h)", map ? "register map" : "home state", failure.reg);
  if (failure.answer == Answer::kNone) return name + " not answered";
  return fmt::format("{} is {:g}, expected {:g}", name, failure.found, failure.expected);
}

class MoteusStartup final : public StartupDialogue {
 public:
  explicit MoteusStartup(const JointConfig& joint);

  CanFrame presence_request() const noexcept override {
    return moteus::encode_state_request(drive_.command_id);
  }
  bool is_presence(const CanFrame& frame) const noexcept override {
    return has_id(frame, drive_.reply_id);
  }

  /// Text is answered from the drive's main loop, not at once.
  int patience_cycles() const noexcept override { return 5; }
  /// The last question is left out if there is no limit_temperature_degC.
  int steps() const noexcept override {
    return std::isfinite(drive_.limit_temperature_degC) ? kSteps : kSteps - 2;
  }
  StartupStep step(int index) const noexcept override;
  CanFrame request(int index) const noexcept override;
  Answer check_answer(int index, const CanFrame& frame, double* found) noexcept override;
  std::string describe(const StartupFailure& failure) const override;

 private:
  /// A line for the diagnostic channel, and what is wanted of the answer.
  struct Question {
    std::string_view line;
    bool (*right)(double found, double expected);  ///< none: any answer
    double expected;
  };
  static constexpr int kRegisters = 2;
  static constexpr int kQuestions = 7;
  static constexpr int kSteps = kRegisters + 2 * kQuestions;  // a line takes two: sent, answered

  static int question_of(int index) noexcept { return (index - kRegisters) / 2; }
  Answer check_register(int index, const CanFrame& frame, double* found) const noexcept;
  Answer check_line(const Question& question, std::string_view text, double* found) noexcept;

  DriveConfig drive_;
  std::array<Question, kQuestions> questions_;
  bool speaks_ = true;  ///< has a diagnostic channel
  std::array<char, 32> line_{};
  std::size_t line_size_ = 0;
};

MoteusStartup::MoteusStartup(const JointConfig& joint) : drive_(joint.drive) {
  const auto turns = [this](double angle_rad) {
    return (drive_.sign * angle_rad + drive_.offset_rad) / kTurn_rad;
  };
  const double a = turns(joint.position_min);
  const double b = turns(joint.position_max);
  questions_ = {{
      {"tel stop", nullptr, 0.0},
      {"conf get servo.pid_position.kp", equal, drive_.range.kp_Nm_per_rad * kTurn_rad},
      {"conf get servo.pid_position.ki", equal, 0.0},  // would act on torque commands, too
      {"conf get servo.pid_position.kd", equal, drive_.range.kd_Nms_per_rad * kTurn_rad},
      {"conf get servopos.position_min", not_above, std::min(a, b)},
      {"conf get servopos.position_max", not_below, std::max(a, b)},
      {"conf get servo.fault_temperature", above, drive_.limit_temperature_degC},
  }};
}

StartupStep MoteusStartup::step(int index) const noexcept {
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

CanFrame MoteusStartup::request(int index) const noexcept {
  if (index < kRegisters)
    return moteus::encode_read(static_cast<Register>(step(index).reg), drive_.command_id);
  const auto question = static_cast<std::size_t>(question_of(index));
  const bool answers = (index - kRegisters) % 2 == 1;
  return answers ? moteus::encode_text_poll(drive_.command_id)
                 : moteus::encode_line(questions_[question].line, drive_.command_id);
}

Answer MoteusStartup::check_answer(int index, const CanFrame& frame, double* found) noexcept {
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

Answer MoteusStartup::check_register(int index, const CanFrame& frame,
                                     double* found) const noexcept {
  const StartupStep planned = step(index);
  if (!moteus::decode_register(frame, static_cast<Register>(planned.reg), found))
    return Answer::kNone;
  const bool right = index == 0 ? *found == planned.expected
                                : *found >= planned.expected && *found <= kHomedOutput;
  return right ? Answer::kRight : Answer::kWrong;
}

/// The answer's line may come in pieces, and other lines before it.
Answer MoteusStartup::check_line(const Question& question, std::string_view text,
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

std::string MoteusStartup::describe(const StartupFailure& failure) const {
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

}  // namespace

std::unique_ptr<StartupDialogue> moteus_startup(const JointConfig& joint) {
  return std::make_unique<MoteusStartup>(joint);
}

}  // namespace limber
