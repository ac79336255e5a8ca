// Start-up of RobStride drives:
//
//   run mode := control, read back -> time-out := watchdog_s, read back
//
// A write is answered with a state, which tells nothing of it; what is read may be refused, and its
// value is 0 then. Both are read again while the drive is on.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "drivers/families/robstride_family.h"
#include "drivers/protocols/robstride.h"

namespace limber {
namespace {

using robstride::Parameter;
using robstride::Type;

class RobstrideStartup final : public StartupDialogue {
 public:
  explicit RobstrideStartup(const DriveConfig& drive) : number_(robstride_number(drive)) {
    const auto counts =
        static_cast<std::uint32_t>(std::lround(drive.watchdog_s / robstride::kTimeoutCount_s));
    steps_ = {{{true, Parameter::kRunMode, 0},
               {false, Parameter::kRunMode, 0},
               {true, Parameter::kTimeout, counts},
               {false, Parameter::kTimeout, counts}}};
  }

  CanFrame presence_request() const noexcept override {
    return robstride::request(Type::kPing, number_);
  }
  bool is_presence(const CanFrame& frame) const noexcept override {
    robstride::Id id{};
    return robstride::split(frame, &id) && id.type == Type::kPing &&
           id.target == robstride::kEverybody && id.data == number_;
  }

  int steps() const noexcept override { return static_cast<int>(steps_.size()); }
  StartupStep step(int index) const noexcept override {
    const Step& step = at(index);
    return {static_cast<std::uint32_t>(step.parameter), static_cast<double>(step.raw)};
  }
  CanFrame request(int index) const noexcept override {
    const Step& step = at(index);
    const auto parameter = static_cast<std::uint16_t>(step.parameter);
    return step.write ? robstride::encode_write(number_, parameter, step.raw)
                      : robstride::encode_read(number_, parameter);
  }
  bool can_be_polled(int index) const noexcept override { return !at(index).write; }
  Answer check_answer(int index, const CanFrame& frame, double* found) noexcept override {
    const Step& step = at(index);
    *found = step.raw;
    robstride::Id id{};
    if (step.write)
      return robstride::split(frame, &id) && id.type == Type::kState &&
                     static_cast<std::uint8_t>(id.data) == number_
                 ? Answer::kRight
                 : Answer::kNone;
    robstride::ParameterAnswer answer;
    if (!robstride::decode_parameter_answer(frame, &answer) || answer.motor != number_ ||
        answer.host != robstride::kHost ||
        answer.index != static_cast<std::uint16_t>(step.parameter))
      return Answer::kNone;
    *found = answer.raw;
    if (answer.refused) return Answer::kRefused;
    return answer.raw == step.raw ? Answer::kRight : Answer::kWrong;
  }
  std::string describe(const StartupFailure& failure) const override {
    if (failure.reg == 0) return StartupDialogue::describe(failure);
    if (failure.answer == Answer::kRefused)
      return fmt::format("parameter {:04X} is refused by its firmware", failure.reg);
    if (failure.answer == Answer::kNone)
      return fmt::format("parameter {:04X} not answered", failure.reg);
    return fmt::format("parameter {:04X} is {:g}, expected {:g}", failure.reg, failure.found,
                       failure.expected);
  }

 private:
  struct Step {
    bool write;
    Parameter parameter;
    std::uint32_t raw;
  };
  const Step& at(int index) const noexcept { return steps_[static_cast<std::size_t>(index)]; }

  std::uint8_t number_;
  std::array<Step, 4> steps_{};
};

}  // namespace

std::unique_ptr<StartupDialogue> robstride_startup(const JointConfig& joint) {
  return std::make_unique<RobstrideStartup>(joint.drive);
}

}  // namespace limber
