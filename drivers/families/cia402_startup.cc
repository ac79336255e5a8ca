#include "drivers/families/cia402_startup.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "drivers/protocols/cia402.h"

namespace limber {
namespace {

using canopen::Object;
using canopen::SdoKind;
using canopen::SdoMessage;

constexpr double kPatience_s = 0.05;  // SDO servers run beside the drive's cycle
constexpr std::uint32_t kProfileMask = 0xFFFF;
constexpr std::uint32_t kProfile = 402;
constexpr std::uint32_t kTorqueMode = 1U << (cia402::kCyclicSynchronousTorque - 1);
constexpr std::uint32_t kPowerBits = 0x07;  // of the statusword: none of them, no torque
constexpr std::uint32_t kSynchronous = 1;
constexpr double kMostPermille = 32767.0;
constexpr std::uint32_t kFaultPowerOff = 0;  // 605Eh
constexpr std::uint32_t kFaultBrakes = 2;    // by the quick stop's ramp

std::uint32_t whole(double value) noexcept {
  return static_cast<std::uint32_t>(std::llround(value));
}
std::uint32_t float_bits(double value) noexcept {
  return std::bit_cast<std::uint32_t>(static_cast<float>(value));
}

/// period_s = count * 10^exponent: the coarsest exponent that is exact, else the finest that eight
/// bits allow.
struct CyclePeriod {
  std::uint32_t count = 255;
  int exponent = -3;
};
CyclePeriod cycle_period(double period_s) noexcept {
  CyclePeriod finest;
  for (int exponent = -3; exponent >= -6; --exponent) {
    const double exact = period_s * std::pow(10.0, -exponent);
    const double count = std::round(exact);
    if (count < 1.0 || count > 255.0) continue;
    finest = {whole(count), exponent};
    if (std::abs(exact - count) <= 1e-6 * count) break;
  }
  return finest;
}

}  // namespace

std::uint32_t most_permille(const JointConfig& joint) noexcept {
  const double limit = std::min(joint.torque_limit_Nm, joint.drive.range.torque_Nm);
  const double permille = 1000.0 * limit / joint.drive.rated_torque_Nm;
  return whole(std::min(std::floor(permille * (1.0 + 1e-12)), kMostPermille));
}

Cia402Startup::Cia402Startup(const JointConfig& joint, double period_s)
    : node_(canopen::node_of(joint.drive.command_id)),
      state_id_(joint.drive.reply_id),
      link_encoder_(joint.link_encoder.present),
      patience_cycles_(std::max(1, static_cast<int>(std::ceil(kPatience_s / period_s)))) {
  steps_.push_back({Kind::kPreOperational, {}, 0, 0, Number::kUnsigned});
  write(cia402::kControlword, cia402::kDisableVoltage);
  await(cia402::kStatusword, 0, kPowerBits);
  plan_identity(joint);
  plan_settings(joint, period_s);
  plan_torque_loop(joint);
  plan_pdo(canopen::kRpdoCommunication, canopen::kRpdoMapping, joint.drive.command_id,
           cia402::command_objects());
  plan_pdo(canopen::kTpdoCommunication, canopen::kTpdoMapping, joint.drive.reply_id,
           cia402::state_objects(link_encoder_));
  steps_.push_back({Kind::kStart, {}, 0, 0, Number::kUnsigned});
}

void Cia402Startup::plan_identity(const JointConfig& joint) {
  compare(canopen::kDeviceType, kProfile, kProfileMask);
  compare(cia402::kSupportedModes, kTorqueMode, kTorqueMode);
  compare(cia402::kRatedTorque_mNm, whole(1000.0 * joint.drive.rated_torque_Nm));
  compare(cia402::kEncoderCounts, 1U << static_cast<unsigned>(joint.drive.encoder_bits));
  if (link_encoder_)
    compare(cia402::kLinkEncoderCounts, 1U << static_cast<unsigned>(joint.link_encoder.bits));
}

void Cia402Startup::plan_settings(const JointConfig& joint, double period_s) {
  write(cia402::kMode, cia402::kCyclicSynchronousTorque);
  await(cia402::kModeInForce, cia402::kCyclicSynchronousTorque);
  write_and_compare(cia402::kMaxTorque, most_permille(joint));
  write_and_compare(canopen::pdo_event_timer_ms(canopen::kRpdoCommunication),
                    std::max(1U, whole(1000.0 * joint.drive.watchdog_s)));
  write_and_compare(cia402::kConnectionLostOption,
                    static_cast<std::uint32_t>(cia402::Reaction::kFault), Number::kSigned);
  const bool damps = joint.drive.watchdog_reaction == NodeWatchdogReaction::kDamp;
  write_and_compare(cia402::kFaultOption, damps ? kFaultBrakes : kFaultPowerOff, Number::kSigned);
  const CyclePeriod period = cycle_period(period_s);
  write_and_compare(cia402::kCyclePeriod, period.count);
  write_and_compare(cia402::kCyclePeriodExponent,
                    static_cast<std::uint32_t>(period.exponent) & 0xFFU, Number::kSigned);
}

void Cia402Startup::plan_torque_loop(const JointConfig& joint) {
  // A drive that one can buy has no such object: it is asked for where robot.yaml tells of it.
  const double lag_s = joint.drive.actuator.lag_s;
  if (lag_s > 0.0) compare(cia402::kCurrentLoopLag_us, whole(1e6 * lag_s));
  if (!joint.torque_sensor.present) return;
  const TorqueLoopConfig& loop = joint.torque_loop;
  write_and_compare(cia402::kInertiaRatio, float_bits(loop.inertia_ratio), Number::kFloat);
  if (!loop.present()) return;
  const TransmissionConfig& transmission = joint.transmission;
  write_and_compare(cia402::kSpringStiffness_Nm_per_rad,
                    float_bits(transmission.spring.stiffness_Nm_per_rad), Number::kFloat);
  write_and_compare(cia402::kSpringDamping_Nms_per_rad,
                    float_bits(transmission.damping_Nms_per_rad), Number::kFloat);
  compare(cia402::kTorqueLoopRate_Hz, whole(loop.rate_hz));
  compare(cia402::kTorqueLoopDelay_us, whole(1e6 * loop.delay_s));
}

// A PDO is mapped while it is switched off (CiA 301).
void Cia402Startup::plan_pdo(std::uint16_t communication, std::uint16_t mapping, std::uint32_t id,
                             std::span<const Object> objects) {
  write(canopen::pdo_cob_id(communication), id | canopen::kPdoDisabled);
  write(canopen::pdo_mapped_count(mapping), 0);
  for (std::size_t i = 0; i < objects.size(); ++i)
    write(canopen::pdo_mapped(mapping, static_cast<int>(i) + 1), objects[i].mapping());
  write(canopen::pdo_mapped_count(mapping), static_cast<std::uint32_t>(objects.size()));
  write(canopen::pdo_type(communication), kSynchronous);
  write(canopen::pdo_cob_id(communication), id);
}

void Cia402Startup::write(const Object& object, std::uint32_t value) {
  steps_.push_back({Kind::kWrite, object, value, 0, Number::kUnsigned});
}

void Cia402Startup::write_and_compare(const Object& object, std::uint32_t value, Number number) {
  write(object, value);
  steps_.push_back({Kind::kCompare, object, value, 0xFFFFFFFF, number});
}

void Cia402Startup::compare(const Object& object, std::uint32_t value, std::uint32_t mask) {
  steps_.push_back({Kind::kCompare, object, value, mask, Number::kUnsigned});
}

void Cia402Startup::await(const Object& object, std::uint32_t value, std::uint32_t mask) {
  steps_.push_back({Kind::kAwait, object, value, mask, Number::kUnsigned});
}

// --- the dialogue --------------------------------------------------------------------------------

double Cia402Startup::value_of(const Step& step, std::uint32_t raw) noexcept {
  if (step.number == Number::kFloat) return std::bit_cast<float>(raw);
  if (step.number == Number::kUnsigned) return raw;
  const auto unused = 32U - 8U * step.object.bytes;
  return static_cast<std::int32_t>(raw << unused) >> unused;
}

StartupQuestion Cia402Startup::question(int index) const noexcept {
  const Step& asked = step(index);
  return {asked.object.id.number(), value_of(asked, asked.value),
          asked.kind != Kind::kPreOperational};
}

CanFrame Cia402Startup::ask(int index) const noexcept {
  const Step& asked = step(index);
  switch (asked.kind) {
    case Kind::kPreOperational:
      return canopen::encode_nmt(canopen::NmtCommand::kPreOperational, node_);
    case Kind::kStart:
      return canopen::encode_nmt(canopen::NmtCommand::kStart, node_);
    case Kind::kWrite:
      return canopen::encode_sdo_write(asked.object, asked.value, node_);
    case Kind::kCompare:
    case Kind::kAwait:
      break;
  }
  return canopen::encode_sdo_read(asked.object.id, node_);
}

Answer Cia402Startup::judge(int index, const CanFrame& frame, double* found) const noexcept {
  const Step& asked = step(index);
  if (asked.kind == Kind::kStart) return judge_started(frame);
  SdoMessage message;
  if (!canopen::decode_sdo_answer(frame, node_, &message) || message.object != asked.object.id)
    return Answer::kNone;
  if (message.kind == SdoKind::kAbort) {
    *found = message.value;
    return Answer::kRefused;
  }
  const bool writing = asked.kind == Kind::kWrite;
  if (message.kind != (writing ? SdoKind::kWrite : SdoKind::kRead)) return Answer::kNone;
  if (writing) return Answer::kRight;
  const std::uint32_t raw = message.value & asked.mask;
  *found = value_of(asked, raw);
  if (raw == asked.value) return Answer::kRight;
  return asked.kind == Kind::kAwait ? Answer::kNotYet : Answer::kWrong;
}

/// Only a node that is operational sends PDOs.
Answer Cia402Startup::judge_started(const CanFrame& frame) const noexcept {
  cia402::DriveState state;
  const bool told = has_id(frame, state_id_) && cia402::decode_state(frame, link_encoder_, &state);
  return told ? Answer::kRight : Answer::kNone;
}

std::string Cia402Startup::describe(const StartupFailure& failure) const {
  if (failure.reg == 0) return "sends no state (TPDO1) after the start";
  const std::string object =
      fmt::format("object {:04X}h:{:02X}", failure.reg >> 8U, failure.reg & 0xFFU);
  switch (failure.answer) {
    case Answer::kNotYet:
      if (failure.reg == cia402::kStatusword.id.number()) return "could not be disabled";
      break;
    case Answer::kRefused:
      return fmt::format("{} refused: {}", object,
                         canopen::text_of(static_cast<canopen::SdoAbort>(failure.found)));
    case Answer::kNone:
    case Answer::kRight:
      return object + " not answered";
    case Answer::kWrong:
      break;
  }
  return fmt::format("{} is {:.10g}, expected {:.10g}", object, failure.found, failure.expected);
}

}  // namespace limber
