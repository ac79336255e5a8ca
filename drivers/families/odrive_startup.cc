// Start-up of ODrive drives:
//
//   firmware, idle, position estimate compared -> limits and torque mode set, read back
//     -> cyclic estimates switched off, time-out and watchdog set, each read back
//
// Endpoints are numbers of the firmware: none is written before others have been read as expected.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "drivers/families/odrive_family.h"
#include "robots/loader/protocols/odrive_endpoints.h"

namespace limber {
namespace {

using odrive::Message;

constexpr std::uint32_t kOdriveFirmware = 100;  // beside the numbers of endpoints
constexpr std::uint32_t kOdriveEstimate = 101;

constexpr std::uint32_t kOdriveSets = 0x100;  // it is written, and that not answered
/// Endpoints, in the order of odrive_endpoints.h, and those above.
constexpr std::array<std::uint32_t, 14> kOdriveSteps = {kOdriveFirmware,
                                                        kOdriveState,
                                                        kOdriveEstimate,
                                                        kOdriveVelocityLimit | kOdriveSets,
                                                        kOdriveVelocityLimit,
                                                        kOdriveControlMode | kOdriveSets,
                                                        kOdriveControlMode,
                                                        kOdriveInputMode,
                                                        kOdriveEstimatesPeriod | kOdriveSets,
                                                        kOdriveEstimatesPeriod,
                                                        kOdriveTimeout | kOdriveSets,
                                                        kOdriveTimeout,
                                                        kOdriveWatchdog | kOdriveSets,
                                                        kOdriveWatchdog};

struct OdriveStep {
  std::uint32_t what;
  bool sets;
};

class OdriveStartup final : public StartupDialogue {
 public:
  explicit OdriveStartup(const JointConfig& joint)
      : drive_(joint.drive),
        node_(odrive_node(drive_)),
        most_A_(static_cast<float>(drive_.peak_torque_Nm / drive_.torque_constant_Nm_per_A)),
        most_turns_per_s_(static_cast<float>(
            2.0 * joint.velocity_limit * odrive_turns_per_rad(drive_) +
            drive_.peak_torque_Nm / drive_.gear_ratio / odrive::kVelocityGain_Nms_per_turn)) {}

  CanFrame presence_request() const noexcept override {
    return odrive::ask(node_, Message::kVersion);
  }
  bool is_presence(const CanFrame& frame) const noexcept override {
    return odrive::is_message(frame, node_, Message::kVersion, 8);
  }
  bool disable_is_answered() const noexcept override { return false; }

  int steps() const noexcept override { return static_cast<int>(kOdriveSteps.size()); }
  StartupStep step(int index) const noexcept override {
    const OdriveStep step = at(index);
    return {step.what, expected(step.what), !step.sets};
  }
  CanFrame request(int index) const noexcept override;
  bool can_be_polled(int index) const noexcept override {
    return at(index).what > kOdriveState && at(index).what < kOdriveFirmware && !at(index).sets;
  }
  Answer check_answer(int index, const CanFrame& frame, double* found) noexcept override;
  std::string describe(const StartupFailure& failure) const override;

 private:
  static OdriveStep at(int index) noexcept {
    const std::uint32_t step = kOdriveSteps[static_cast<std::size_t>(index)];
    return {step & ~kOdriveSets, (step & kOdriveSets) != 0};
  }
  double expected(std::uint32_t what) const noexcept {
    switch (what) {
      case kOdriveFirmware:
        return drive_.firmware & 0xFFU;
      case kOdriveVelocityLimit:
        return most_turns_per_s_;
      case kOdriveTimeout:
        return static_cast<float>(drive_.watchdog_s);
      case kOdriveEstimatesPeriod:
      case kOdriveEstimate:
        return 0.0;
      default:
        return 1.0;  // idle, torque control, passed through, on
    }
  }

  DriveConfig drive_;
  std::uint32_t node_;
  float most_A_;
  float most_turns_per_s_;
};

CanFrame OdriveStartup::request(int index) const noexcept {
  const OdriveStep step = at(index);
  if (step.what == kOdriveFirmware) return presence_request();
  if (step.what == kOdriveEstimate) return odrive::ask(node_, Message::kEstimates);
  const std::uint16_t endpoint = drive_.endpoints[step.what];
  if (!step.sets) return odrive::read_endpoint(node_, endpoint);
  if (step.what == kOdriveVelocityLimit)
    return odrive::encode(node_, Message::kSetLimits, most_turns_per_s_, most_A_);
  if (step.what == kOdriveControlMode)
    return odrive::encode(node_, Message::kSetMode, odrive::kTorqueControl, odrive::kPassThrough);
  const auto write = [&](auto value) {
    return odrive::encode(node_, Message::kWriteEndpoint, std::uint8_t{1}, endpoint,
                          std::uint8_t{0}, value);
  };
  if (step.what == kOdriveTimeout) return write(static_cast<float>(drive_.watchdog_s));
  return step.what == kOdriveWatchdog ? write(std::uint8_t{1}) : write(0U);
}

Answer OdriveStartup::check_answer(int index, const CanFrame& frame, double* found) noexcept {
  const OdriveStep step = at(index);
  if (step.sets) return Answer::kNone;
  if (step.what == kOdriveFirmware) {
    if (!is_presence(frame)) return Answer::kNone;
    *found = frame.data[6];
    const bool same = (frame.data[4] << 16U | frame.data[5] << 8U | frame.data[6]) ==
                      static_cast<int>(drive_.firmware);
    return same ? Answer::kRight : Answer::kWrong;
  }
  if (step.what == kOdriveEstimate) {
    if (!odrive::is_message(frame, node_, Message::kEstimates, 8)) return Answer::kNone;
    *found = odrive::field<float>(frame, 0);
    return std::isfinite(*found) ? Answer::kRight : Answer::kWrong;
  }
  const OdriveEndpointKind& kind = kOdriveEndpoints[step.what];
  if (!odrive::decode_endpoint(frame, node_, drive_.endpoints[step.what], kind.bytes, kind.real,
                               found))
    return Answer::kNone;
  if (*found == expected(step.what)) return Answer::kRight;
  return step.what == kOdriveState ? Answer::kNotYet : Answer::kWrong;
}

std::string OdriveStartup::describe(const StartupFailure& failure) const {
  if (failure.answer == Answer::kNone)
    return failure.reg == kOdriveFirmware || failure.reg == kOdriveEstimate
               ? "it does not answer"
               : fmt::format("endpoint {} ({}) not answered", drive_.endpoints[failure.reg],
                             kOdriveEndpoints[failure.reg].name);
  if (failure.reg == kOdriveFirmware)
    return fmt::format(
        "firmware 0.6.{:g}, or of another generation, expected 0.6.{:g}: its "
        "endpoints have other numbers",
        failure.found, failure.expected);
  if (failure.reg == kOdriveEstimate) return "no position estimate: calibrate its encoder";
  return fmt::format("{} is {:g}, expected {:g}", kOdriveEndpoints[failure.reg].name, failure.found,
                     failure.expected);
}

}  // namespace

std::unique_ptr<StartupDialogue> odrive_startup(const JointConfig& joint) {
  return std::make_unique<OdriveStartup>(joint);
}

}  // namespace limber
