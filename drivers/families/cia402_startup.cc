// The start-up dialogue of a CANopen drive as a table: what is written, what is compared.
//
//   NMT pre-operational -> power stage off -> is it the drive that robot.yaml describes ->
//   mode, limit, watchdog, period, torque loop: written and read back -> PDOs mapped ->
//   NMT start, answered by the first TPDOs
//
// All by SDO (CiA 301), one transfer after the other, each with a second's time. Objects that the
// profile leaves to the maker may be missing.
#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "drivers/families/cia402_family.h"
#include "drivers/families/cia402_state.h"
#include "drivers/protocols/canopen_sdo.h"
#include "drivers/protocols/cia402_pdos.h"

namespace limber {
namespace {

using canopen::Object;
using canopen::SdoKind;
using canopen::SdoMessage;

constexpr double kPatience_s = 1.0;  // SDO servers run beside the drive's cycle
constexpr std::uint32_t kProfileMask = 0xFFFF;
constexpr std::uint32_t kProfile = 402;
constexpr std::uint32_t kTorqueMode = 1U << (cia402::kCyclicSynchronousTorque - 1);
constexpr std::uint32_t kPowerBits = 0x07;  // of the statusword: none of them, no torque
constexpr std::uint32_t kSynchronous = 1;
constexpr std::uint32_t kFaultPowerOff = 0;  // 605Eh
constexpr std::uint32_t kFaultBrakes = 2;    // by the quick stop's ramp
constexpr double kCountsAgree = 1e-9;        // of themselves

// Counts per turn of the joint: first over second, times third over fourth.
constexpr std::array kCountsObjects = {cia402::kEncoderCounts, cia402::kEncoderTurns,
                                       cia402::kGearMotorTurns, cia402::kGearJointTurns};

/// What it means that a drive has no such object.
struct MissingObject {
  canopen::ObjectId id;
  const char* meaning;
};
constexpr std::array kMayBeMissing = {
    MissingObject{canopen::pdo_event_timer_ms(canopen::kRpdoCommunication).id,
                  "the drive does not notice that its commands have stopped"},
    MissingObject{cia402::kConnectionLostOption.id,
                  "what the drive does when its commands stop is its maker's choice"},
    MissingObject{cia402::kFaultOption.id, "what the drive does in a fault is its maker's choice"},
    MissingObject{cia402::kCyclePeriod.id, "the drive is not told the cycle time"},
    MissingObject{cia402::kCyclePeriodExponent.id, "the drive is not told the cycle time"},
};

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
    if (count > 255.0) continue;
    finest = {whole(count), exponent};
    if (std::abs(exact - count) <= 1e-6 * count) break;
  }
  return finest;
}

class Cia402Startup final : public StartupDialogue {
 public:
  Cia402Startup(const JointConfig& joint, const cia402::StateLayout& layout, double period_s);

  CanFrame presence_request() const noexcept override {
    return canopen::encode_sdo_read(canopen::kDeviceType.id, node_);
  }
  bool is_presence(const CanFrame& frame) const noexcept override;

  void begin_cycle() noexcept override { first_state_.begin(); }
  bool disable_is_answered() const noexcept override { return false; }
  int patience_cycles() const noexcept override { return patience_cycles_; }
  int steps() const noexcept override { return static_cast<int>(steps_.size()); }
  StartupStep step(int index) const noexcept override;
  CanFrame request(int index) const noexcept override;
  /// What is compared, and the mode in force; of the state the power is awaited to be off.
  bool can_be_polled(int index) const noexcept override;
  Answer check_answer(int index, const CanFrame& frame, double* found) noexcept override;
  std::string describe(const StartupFailure& failure) const override;

 private:
  enum class Kind : std::uint8_t {
    kPreOperational,
    kWrite,
    kCompare,  ///< the bits of the mask, of what is read, with the value
    kAwait,    ///< likewise; a drive may take its time
    kCounts,   ///< one of the numbers that make counts per turn; at the last, that is compared
    kStart,
  };
  /// If the drive has no such object.
  enum class Absence : std::uint8_t {
    kRefused,
    kWarned,
    kSilent,  ///< nothing to write, or 1
  };
  enum class Number : std::uint8_t { kUnsigned, kSigned, kFloat };
  struct Step {
    Kind kind;
    canopen::Object object = {};
    std::uint32_t value = 0;
    std::uint32_t mask = 0xFFFFFFFF;
    Number number = Number::kUnsigned;
    Absence absence = Absence::kRefused;
  };

  void plan_identity(const JointConfig& joint);
  void plan_settings(const JointConfig& joint, double period_s);
  void plan_torque_loop(const JointConfig& joint);
  void plan_pdo(std::uint16_t communication, std::uint16_t mapping, std::uint32_t id,
                std::span<const canopen::Object> objects);
  void switch_off_tpdo(int k);
  void write(const canopen::Object& object, std::uint32_t value,
             Absence absence = Absence::kRefused);
  void write_and_compare(const canopen::Object& object, std::uint32_t value,
                         Number number = Number::kUnsigned, Absence absence = Absence::kRefused);
  void compare(const canopen::Object& object, std::uint32_t value, std::uint32_t mask = 0xFFFFFFFF);
  void await(const canopen::Object& object, std::uint32_t value, std::uint32_t mask = 0xFFFFFFFF);

  const Step& planned_step(int index) const noexcept {
    return steps_[static_cast<std::size_t>(index)];
  }
  Answer check_first_state(const CanFrame& frame) noexcept;
  static double value_of(const Step& step, std::uint32_t raw) noexcept;
  Answer check_absence(const Step& planned, std::uint32_t abort_code, double* found) noexcept;
  Answer check_counts(const Step& planned, std::uint32_t value, double* found) noexcept;

  std::uint8_t node_;
  Cia402State first_state_;
  int tpdos_;
  double counts_per_turn_;
  int patience_cycles_;
  std::vector<Step> steps_;
  std::array<double, 4> counts_read_{};  ///< in the order of their steps
};

Cia402Startup::Cia402Startup(const JointConfig& joint, const cia402::StateLayout& layout,
                             double period_s)
    : node_(canopen::node_of(joint.drive.command_id)),
      first_state_(layout, node_),
      tpdos_(cia402::tpdos_of(layout)),
      counts_per_turn_(joint.drive.counts_per_turn),
      patience_cycles_(static_cast<int>(std::ceil(kPatience_s / period_s))) {
  steps_.push_back({.kind = Kind::kPreOperational});
  write(cia402::kControlword, cia402::kDisableVoltage);
  await(cia402::kStatusword, 0, kPowerBits);
  plan_identity(joint);
  plan_settings(joint, period_s);
  plan_torque_loop(joint);
  plan_pdo(canopen::kRpdoCommunication, canopen::kRpdoMapping, joint.drive.command_id,
           cia402::command_objects());
  for (int k = 0; k < canopen::kPdos; ++k) {
    const auto offset = static_cast<std::uint16_t>(k);
    if (k < tpdos_)
      plan_pdo(canopen::kTpdoCommunication + offset, canopen::kTpdoMapping + offset,
               canopen::tpdo_id(k, node_), cia402::state_objects(layout, k));
    else
      switch_off_tpdo(k);
  }
  steps_.push_back({.kind = Kind::kStart});
}

void Cia402Startup::plan_identity(const JointConfig& joint) {
  compare(canopen::kDeviceType, kProfile, kProfileMask);
  compare(cia402::kSupportedModes, kTorqueMode, kTorqueMode);
  compare(cia402::kRatedTorque_mNm, whole(1000.0 * joint.drive.rated_torque_Nm));
  for (std::size_t i = 0; i < kCountsObjects.size(); ++i)
    steps_.push_back({.kind = Kind::kCounts,
                      .object = kCountsObjects[i],
                      .value = static_cast<std::uint32_t>(i),
                      .absence = i == 0 ? Absence::kRefused : Absence::kSilent});
  if (joint.link_encoder.present)
    compare(cia402::kLinkEncoderCounts, 1U << static_cast<unsigned>(joint.link_encoder.bits));
}

void Cia402Startup::plan_settings(const JointConfig& joint, double period_s) {
  write(cia402::kMode, cia402::kCyclicSynchronousTorque);
  await(cia402::kModeInForce, cia402::kCyclicSynchronousTorque);
  write_and_compare(cia402::kMaxTorque, cia402::most_permille(joint));
  write_and_compare(canopen::pdo_event_timer_ms(canopen::kRpdoCommunication),
                    whole(1000.0 * joint.drive.watchdog_s), Number::kUnsigned, Absence::kWarned);
  write_and_compare(cia402::kConnectionLostOption,
                    static_cast<std::uint32_t>(cia402::Reaction::kFault), Number::kSigned,
                    Absence::kWarned);
  const bool damps = joint.drive.watchdog_reaction == NodeWatchdogReaction::kDamp;
  write_and_compare(cia402::kFaultOption, damps ? kFaultBrakes : kFaultPowerOff, Number::kSigned,
                    Absence::kWarned);
  const CyclePeriod period = cycle_period(period_s);
  write_and_compare(cia402::kCyclePeriod, period.count, Number::kUnsigned, Absence::kWarned);
  write_and_compare(cia402::kCyclePeriodExponent,
                    static_cast<std::uint32_t>(period.exponent) & 0xFFU, Number::kSigned,
                    Absence::kWarned);
}

void Cia402Startup::plan_torque_loop(const JointConfig& joint) {
  // Drives off the shelf have no such object: it is read where robot.yaml describes a current loop.
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

/// As a drive is delivered, it may send TPDOs of its own.
void Cia402Startup::switch_off_tpdo(int k) {
  const auto record = static_cast<std::uint16_t>(canopen::kTpdoCommunication + k);
  write(canopen::pdo_cob_id(record), canopen::tpdo_id(k, node_) | canopen::kPdoDisabled,
        Absence::kSilent);
}

void Cia402Startup::write(const Object& object, std::uint32_t value, Absence absence) {
  steps_.push_back({.kind = Kind::kWrite, .object = object, .value = value, .absence = absence});
}

void Cia402Startup::write_and_compare(const Object& object, std::uint32_t value, Number number,
                                      Absence absence) {
  write(object, value, absence);
  steps_.push_back({.kind = Kind::kCompare,
                    .object = object,
                    .value = value,
                    .number = number,
                    .absence = absence});
}

void Cia402Startup::compare(const Object& object, std::uint32_t value, std::uint32_t mask) {
  steps_.push_back({.kind = Kind::kCompare, .object = object, .value = value, .mask = mask});
}

void Cia402Startup::await(const Object& object, std::uint32_t value, std::uint32_t mask) {
  steps_.push_back({.kind = Kind::kAwait, .object = object, .value = value, .mask = mask});
}

bool Cia402Startup::is_presence(const CanFrame& frame) const noexcept {
  canopen::SdoMessage answer;
  return canopen::decode_sdo_answer(frame, node_, &answer) &&
         answer.object == canopen::kDeviceType.id;
}

// --- the dialogue --------------------------------------------------------------------------------

double Cia402Startup::value_of(const Step& step, std::uint32_t raw) noexcept {
  if (step.number == Number::kFloat) return std::bit_cast<float>(raw);
  if (step.number == Number::kUnsigned) return raw;
  const auto unused = 32U - 8U * step.object.bytes;
  return static_cast<std::int32_t>(raw << unused) >> unused;
}

StartupStep Cia402Startup::step(int index) const noexcept {
  const Step& planned = planned_step(index);
  const double expected =
      planned.kind == Kind::kCounts ? counts_per_turn_ : value_of(planned, planned.value);
  return {planned.object.id.number(), expected, planned.kind != Kind::kPreOperational};
}

CanFrame Cia402Startup::request(int index) const noexcept {
  const Step& planned = planned_step(index);
  switch (planned.kind) {
    case Kind::kPreOperational:
      return canopen::encode_nmt(canopen::NmtCommand::kPreOperational, node_);
    case Kind::kStart:
      return canopen::encode_nmt(canopen::NmtCommand::kStart, node_);
    case Kind::kWrite:
      return canopen::encode_sdo_write(planned.object, planned.value, node_);
    case Kind::kCompare:
    case Kind::kAwait:
    case Kind::kCounts:
      break;
  }
  return canopen::encode_sdo_read(planned.object.id, node_);
}

bool Cia402Startup::can_be_polled(int index) const noexcept {
  const Step& planned = planned_step(index);
  if (planned.kind == Kind::kAwait) return planned.object.id == cia402::kModeInForce.id;
  return planned.kind == Kind::kCompare || planned.kind == Kind::kCounts;
}

Answer Cia402Startup::check_answer(int index, const CanFrame& frame, double* found) noexcept {
  const Step& planned = planned_step(index);
  *found = 0.0;
  if (planned.kind == Kind::kStart) return check_first_state(frame);
  SdoMessage message;
  if (!canopen::decode_sdo_answer(frame, node_, &message) || message.object != planned.object.id)
    return Answer::kNone;
  if (message.kind == SdoKind::kAbort) return check_absence(planned, message.value, found);
  const bool writing = planned.kind == Kind::kWrite;
  if (message.kind != (writing ? SdoKind::kWrite : SdoKind::kRead)) return Answer::kNone;
  if (writing) return Answer::kRight;
  if (planned.kind == Kind::kCounts) return check_counts(planned, message.value, found);
  const std::uint32_t raw = message.value & planned.mask;
  *found = value_of(planned, raw);
  if (raw == planned.value) return Answer::kRight;
  return planned.kind == Kind::kAwait ? Answer::kNotYet : Answer::kWrong;
}

/// Only a node that is operational sends PDOs.
Answer Cia402Startup::check_first_state(const CanFrame& frame) noexcept {
  switch (first_state_.take(frame)) {
    case StateReading::kWhole:
      return Answer::kRight;
    case StateReading::kPart:
      return Answer::kNotYet;
    case StateReading::kNone:
      break;
  }
  return Answer::kNone;
}

Answer Cia402Startup::check_absence(const Step& planned, std::uint32_t abort_code,
                                    double* found) noexcept {
  const auto code = static_cast<canopen::SdoAbort>(abort_code);
  const bool absent =
      code == canopen::SdoAbort::kNoSuchObject || code == canopen::SdoAbort::kNoSuchSub;
  *found = abort_code;
  if (!absent || planned.absence == Absence::kRefused) return Answer::kRefused;
  if (planned.absence == Absence::kWarned) return Answer::kMissing;
  return planned.kind == Kind::kCounts ? check_counts(planned, 1, found) : Answer::kRight;
}

Answer Cia402Startup::check_counts(const Step& planned, std::uint32_t value,
                                   double* found) noexcept {
  counts_read_[planned.value] = value;
  if (planned.value + 1 < counts_read_.size()) return Answer::kRight;
  const auto [counts, turns, motor_turns, joint_turns] = counts_read_;
  *found = counts / turns * (motor_turns / joint_turns);
  const bool right = std::abs(*found - counts_per_turn_) <= kCountsAgree * counts_per_turn_;
  return right ? Answer::kRight : Answer::kWrong;
}

std::string Cia402Startup::describe(const StartupFailure& failure) const {
  if (failure.reg == 0)
    return failure.answer == Answer::kNotYet
               ? fmt::format("sends some, but not all of its {} TPDOs after the start", tpdos_)
               : "sends no state (TPDO1) after the start";
  const std::string object =
      fmt::format("object {:04X}h:{:02X}", failure.reg >> 8U, failure.reg & 0xFFU);
  switch (failure.answer) {
    case Answer::kNotYet:
      if (failure.reg == cia402::kStatusword.id.number()) return "could not be disabled";
      break;
    case Answer::kRefused:
      return fmt::format("{} refused: {}", object,
                         canopen::text_of(static_cast<canopen::SdoAbort>(failure.found)));
    case Answer::kMissing:
      for (const MissingObject& missing : kMayBeMissing) {
        if (missing.id.number() == failure.reg)
          return fmt::format("{} is missing: {}", object, missing.meaning);
      }
      break;
    case Answer::kNone:
    case Answer::kRight:
      return object + " not answered";
    case Answer::kWrong:
      if (failure.reg == kCountsObjects.back().id.number())
        return fmt::format("counts {:.10g} a turn of the joint (608Fh, 6091h), expected {:.10g}",
                           failure.found, failure.expected);
      if (failure.reg == cia402::kSupportedModes.id.number())
        return "has no cyclic synchronous torque mode (6502h, bit 9 is 0)";
      if (failure.reg == canopen::kDeviceType.id.number())
        return fmt::format("is no CiA 402 drive: object 1000h has profile {:.0f}, expected {}",
                           failure.found, kProfile);
      break;
  }
  return fmt::format("{} is {:.10g}, expected {:.10g}", object, failure.found, failure.expected);
}

}  // namespace

std::unique_ptr<StartupDialogue> cia402_startup(const JointConfig& joint, bool fd,
                                                double period_s) {
  return std::make_unique<Cia402Startup>(joint, cia402::layout_of(joint, fd), period_s);
}

}  // namespace limber
