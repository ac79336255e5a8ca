#include "sim/nodes/cia402_objects.h"

#include <algorithm>
#include <cmath>

#include "drivers/protocols/cia402.h"

namespace limber::sim {
namespace {

using enum ValueType;

constexpr double kMillis = 1000.0;
constexpr double kMicros = 1e6;
constexpr double kMostPermille = 65535.0;
constexpr double kBraking = 2.0;  // fault option; 0: the power stage is off

void read_only(CanopenDictionary* dictionary, const cia402::Object& object, ValueType type,
               double value, Mapping mapping = Mapping::kNo) {
  dictionary->add(object, type, value, Access::kReadOnly, mapping);
}

void count_of(CanopenDictionary* dictionary, const cia402::Object& record, double last) {
  read_only(dictionary, {{record.id.index, 0}, 1}, kU8, last);
}

/// The fewest turns with a whole number of counts; 1 if 32 bits are not enough.
double whole_turns(double counts_per_turn) {
  for (double turns = 1.0; turns * counts_per_turn < 0x1p32; ++turns) {
    const double counts = turns * counts_per_turn;
    if (std::abs(counts - std::round(counts)) < 1e-9 * counts) return turns;
  }
  return 1.0;
}

double supply_V(const DriveConfig& drive) {
  constexpr double kUsual_V = 48.0;
  return std::isfinite(drive.actuator.supply_V) ? drive.actuator.supply_V : kUsual_V;
}

void add_commands(CanopenDictionary* dictionary) {
  constexpr double kI16 = 32767.0;
  const auto add = [dictionary](const cia402::Object& object, ValueType type, double value,
                                double min, double max) {
    dictionary->add_writable(object, type, value, min, max, Mapping::kYes);
  };
  add(cia402::kControlword, kU16, 0.0, 0.0, 65535.0);
  add(cia402::kMode, kI8, 0.0, -128.0, 127.0);
  add(cia402::kTargetTorque, ValueType::kI16, 0.0, -kI16 - 1.0, kI16);
  add(cia402::kTorqueOffset, ValueType::kI16, 0.0, -kI16 - 1.0, kI16);
}

void add_measured(CanopenDictionary* dictionary, const LinkEncoderConfig& link_encoder) {
  const auto add = [dictionary](const cia402::Object& object, ValueType type) {
    read_only(dictionary, object, type, 0.0, Mapping::kYes);
  };
  add(cia402::kErrorCode, kU16);
  add(cia402::kStatusword, kU16);
  add(cia402::kModeInForce, kI8);
  add(cia402::kPosition, kI32);
  add(cia402::kVelocity, kI32);
  add(cia402::kTorqueDemand, kI16);
  add(cia402::kTorqueActual, kI16);
  add(cia402::kCurrentActual, kI16);
  add(cia402::kDigitalInputs, kU32);
  if (!link_encoder.present) return;
  count_of(dictionary, cia402::kLinkPosition, 1);
  add(cia402::kLinkPosition, kI32);
  add(cia402::kLinkVelocity, kI32);
  count_of(dictionary, cia402::kLinkEncoderCounts, 1);
  read_only(dictionary, cia402::kLinkEncoderCounts, kU32, std::ldexp(1.0, link_encoder.bits));
}

void add_scales(CanopenDictionary* dictionary, const DriveConfig& drive) {
  const double rated_current_A = drive.rated_torque_Nm / drive.torque_constant_Nm_per_A;
  const double peak = std::floor(1e3 * drive.peak_torque_Nm / drive.rated_torque_Nm);
  read_only(dictionary, cia402::kRatedTorque_mNm, kU32,
            std::round(kMillis * drive.rated_torque_Nm));
  read_only(dictionary, cia402::kRatedCurrent_mA, kU32, std::round(kMillis * rated_current_A));
  read_only(dictionary, cia402::kSupply_mV, kU32, std::round(kMillis * supply_V(drive)),
            Mapping::kYes);
  dictionary->add_writable(cia402::kMaxTorque, kU16, std::min(peak, kMostPermille), 0.0,
                           kMostPermille, Mapping::kYes);
  // The encoder seems to sit on the joint; a count per turn that is not whole needs several turns.
  const double turns = whole_turns(drive.counts_per_turn);
  count_of(dictionary, cia402::kEncoderCounts, 2);
  read_only(dictionary, cia402::kEncoderCounts, kU32, std::round(turns * drive.counts_per_turn));
  read_only(dictionary, cia402::kEncoderTurns, kU32, turns);
  count_of(dictionary, cia402::kGearMotorTurns, 2);
  read_only(dictionary, cia402::kGearMotorTurns, kU32, 1);
  read_only(dictionary, cia402::kGearJointTurns, kU32, 1);
}

void add_behaviour(CanopenDictionary* dictionary, const DriveConfig& drive) {
  const bool brakes = drive.watchdog_reaction == NodeWatchdogReaction::kDamp;
  dictionary->add_writable(cia402::kQuickStopOption, kI16, 2, 0, 8);
  for (const cia402::Object& let_go :
       {cia402::kShutdownOption, cia402::kDisableOption, cia402::kHaltOption})
    dictionary->add_writable(let_go, kI16, 0, 0, 0);
  dictionary->add_writable(cia402::kFaultOption, kI16, brakes ? kBraking : 0.0, 0, kBraking);
  dictionary->add_writable(cia402::kConnectionLostOption, kI16,
                           static_cast<double>(cia402::Reaction::kFault), 0, 3);
  count_of(dictionary, cia402::kCyclePeriod, 2);
  dictionary->add_writable(cia402::kCyclePeriod, kU8, 1, 1, 255);
  dictionary->add_writable(cia402::kCyclePeriodExponent, kI8, -3, -128, 63);
  read_only(dictionary, cia402::kSupportedModes, kU32,
            1U << static_cast<unsigned>(cia402::kCyclicSynchronousTorque - 1));
  dictionary->add_text({0x6403, 0}, drive.motor, Access::kReadWrite);  // motor catalogue number
}

void add_torque_loop(CanopenDictionary* dictionary, const JointConfig& joint) {
  constexpr double kMost = 1e9;
  const auto add = [&](const cia402::Object& object, double value, double min, double max) {
    if (joint.torque_sensor.present)
      dictionary->add_writable(object, kFloat, value, min, max);
    else
      read_only(dictionary, object, kFloat, value);
  };
  const TransmissionConfig& transmission = joint.transmission;
  const double stiffness = transmission.spring.stiffness_Nm_per_rad;
  count_of(dictionary, cia402::kInertiaRatio, 5);
  add(cia402::kInertiaRatio, joint.torque_loop.inertia_ratio, 1.0, 100.0);
  add(cia402::kSpringStiffness_Nm_per_rad, stiffness, 0.0, kMost);
  add(cia402::kSpringDamping_Nms_per_rad, transmission.damping_Nms_per_rad, 0.0, kMost);
  read_only(dictionary, cia402::kTorqueLoopRate_Hz, kU32, std::round(joint.torque_loop.rate_hz));
  read_only(dictionary, cia402::kTorqueLoopDelay_us, kU32,
            std::round(kMicros * joint.torque_loop.delay_s));
  count_of(dictionary, cia402::kCurrentLoopLag_us, 1);
  read_only(dictionary, cia402::kCurrentLoopLag_us, kU32,
            std::round(kMicros * joint.drive.actuator.lag_s));
}

}  // namespace

CanopenDictionary cia402_objects(const JointConfig& joint) {
  CanopenDictionary dictionary;
  add_commands(&dictionary);
  add_measured(&dictionary, joint.link_encoder);
  add_scales(&dictionary, joint.drive);
  add_behaviour(&dictionary, joint.drive);
  add_torque_loop(&dictionary, joint);
  return dictionary;
}

}  // namespace limber::sim
