#include "tools/can/canopen_objects.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "drivers/protocols/cia402.h"
#include "drivers/protocols/mit.h"

namespace limber::bus_tools {
namespace {

using canopen::ObjectId;

/// By number, so that the table does not depend on which of them limber uses today.
struct NamedObject {
  ObjectId id;
  const char* name;
  ObjectKind kind;
  const char* unit = "";
};
constexpr NamedObject kNamedObjects[] = {
    {{0x1000, 0}, "device type", ObjectKind::kBits},
    {{0x1001, 0}, "error register", ObjectKind::kBits},
    {{0x1003, 0}, "number of errors", ObjectKind::kUnsigned},
    {{0x1005, 0}, "SYNC COB-ID", ObjectKind::kBits},
    {{0x1008, 0}, "device name", ObjectKind::kBits},
    {{0x100A, 0}, "software version", ObjectKind::kBits},
    {{0x1016, 1}, "consumer heartbeat", ObjectKind::kBits},
    {{0x1017, 0}, "heartbeat period", ObjectKind::kUnsigned, "ms"},
    {{0x1018, 1}, "vendor", ObjectKind::kBits},
    {{0x1018, 2}, "product code", ObjectKind::kBits},
    {{0x1019, 0}, "SYNC counter overflow", ObjectKind::kUnsigned},
    {{0x1029, 1}, "error behaviour", ObjectKind::kUnsigned},
    {{0x2010, 1}, "inertia ratio", ObjectKind::kFloat},
    {{0x2010, 2}, "spring stiffness", ObjectKind::kFloat, "N m/rad"},
    {{0x2010, 3}, "spring damping", ObjectKind::kFloat, "N m s/rad"},
    {{0x2010, 4}, "torque loop rate", ObjectKind::kUnsigned, "Hz"},
    {{0x2010, 5}, "torque loop delay", ObjectKind::kUnsigned, "us"},
    {{0x2011, 1}, "current loop lag", ObjectKind::kUnsigned, "us"},
    {{0x2069, 0}, "link velocity", ObjectKind::kLinkCounts, "rad/s"},
    {{0x6007, 0}, "connection lost option", ObjectKind::kSigned},
    {{0x603F, 0}, "error code", ObjectKind::kBits},
    {{0x6040, 0}, "controlword", ObjectKind::kControlword},
    {{0x6041, 0}, "statusword", ObjectKind::kStatusword},
    {{0x605A, 0}, "quick stop option", ObjectKind::kSigned},
    {{0x605C, 0}, "disable option", ObjectKind::kSigned},
    {{0x605E, 0}, "fault reaction option", ObjectKind::kSigned},
    {{0x6060, 0}, "mode", ObjectKind::kSigned},
    {{0x6061, 0}, "mode in force", ObjectKind::kSigned},
    {{0x6064, 0}, "position", ObjectKind::kCounts, "rad"},
    {{0x606C, 0}, "velocity", ObjectKind::kCounts, "rad/s"},
    {{0x6071, 0}, "target torque", ObjectKind::kPermilleTorque, "N m"},
    {{0x6072, 0}, "maximum torque", ObjectKind::kUnsigned, "thousandths"},
    {{0x6074, 0}, "torque demand", ObjectKind::kPermilleTorque, "N m"},
    {{0x6075, 0}, "rated current", ObjectKind::kUnsigned, "mA"},
    {{0x6076, 0}, "rated torque", ObjectKind::kUnsigned, "mN m"},
    {{0x6077, 0}, "torque", ObjectKind::kPermilleTorque, "N m"},
    {{0x6078, 0}, "current", ObjectKind::kPermilleCurrent, "A"},
    {{0x608F, 1}, "encoder counts", ObjectKind::kUnsigned},
    {{0x608F, 2}, "encoder turns", ObjectKind::kUnsigned},
    {{0x6091, 1}, "gear motor turns", ObjectKind::kUnsigned},
    {{0x6091, 2}, "gear joint turns", ObjectKind::kUnsigned},
    {{0x60B2, 0}, "torque offset", ObjectKind::kPermilleTorque, "N m"},
    {{0x60C2, 1}, "cycle period", ObjectKind::kUnsigned},
    {{0x60C2, 2}, "cycle period exponent", ObjectKind::kSigned},
    {{0x60E4, 1}, "link position", ObjectKind::kLinkCounts, "rad"},
    {{0x60E6, 1}, "link encoder counts", ObjectKind::kUnsigned},
    {{0x6502, 0}, "supported modes", ObjectKind::kBits},
};

constexpr std::uint16_t kRecords = 0x200;  // of each of the four kinds of PDO records

ObjectRow communication_row(const std::string& pdo, std::uint8_t sub) {
  switch (sub) {
    case 1:
      return {pdo + " COB-ID", ObjectKind::kBits, ""};
    case 2:
      return {pdo + " type", ObjectKind::kUnsigned, ""};
    case 3:
      return {pdo + " inhibit time", ObjectKind::kUnsigned, "x 100 us"};
    case 5:
      return {pdo + " event timer", ObjectKind::kUnsigned, "ms"};
    default:
      return {pdo + fmt::format(" communication :{:02X}", sub), ObjectKind::kBits, ""};
  }
}

ObjectRow mapping_row(const std::string& pdo, std::uint8_t sub) {
  if (sub == 0) return {pdo + " mapped objects", ObjectKind::kUnsigned, ""};
  return {fmt::format("{} mapping {}", pdo, sub), ObjectKind::kMapping, ""};
}

const char* command_word(std::uint16_t controlword) {
  switch (cia402::command_of(controlword, 0)) {
    case cia402::Command::kShutdown:
      return "shutdown";
    case cia402::Command::kSwitchOn:
      return "switch on";
    case cia402::Command::kEnableOperation:
      return "enable operation";
    case cia402::Command::kDisableVoltage:
      return "disable voltage";
    case cia402::Command::kQuickStop:
      return "quick stop";
    case cia402::Command::kFaultReset:
      return "fault reset";
    case cia402::Command::kNone:
      break;
  }
  return "no command";
}

std::int32_t extended(std::uint32_t raw, int bytes) {
  const auto unused = static_cast<unsigned>(32 - 8 * bytes);
  return static_cast<std::int32_t>(raw << unused) >> unused;
}

std::string mapping_text(std::uint32_t raw) {
  const ObjectId id{static_cast<std::uint16_t>(raw >> 16U), static_cast<std::uint8_t>(raw >> 8U)};
  return fmt::format("{} {}, {} bits", object_number(id), object_row(id).name, raw & 0xFFU);
}

}  // namespace

std::string object_number(ObjectId id) { return fmt::format("{:04X}h:{:02X}", id.index, id.sub); }

ObjectRow object_row(ObjectId id) {
  for (const NamedObject& object : kNamedObjects) {
    if (object.id == id) return {object.name, object.kind, object.unit};
  }
  struct Records {
    std::uint16_t first;
    const char* pdo;
    ObjectRow (*row)(const std::string&, std::uint8_t);
  };
  constexpr Records kPdoRecords[] = {
      {canopen::kRpdoCommunication, "RPDO", communication_row},
      {canopen::kRpdoMapping, "RPDO", mapping_row},
      {canopen::kTpdoCommunication, "TPDO", communication_row},
      {canopen::kTpdoMapping, "TPDO", mapping_row},
  };
  for (const Records& records : kPdoRecords) {
    if (id.index < records.first || id.index >= records.first + kRecords) continue;
    return records.row(records.pdo + std::to_string(id.index - records.first + 1), id.sub);
  }
  return {"object " + object_number(id), ObjectKind::kBits, ""};
}

DriveScale::DriveScale(const Motor& motor, double rad_per_count_of_motor)
    : rad_per_count(rad_per_count_of_motor),
      link_rad_per_count(std::ldexp(2.0 * std::numbers::pi, -motor.joint.link_encoder.bits)),
      rated_torque_Nm(motor.joint.drive.rated_torque_Nm),
      rated_current_A(rated_torque_Nm / motor.joint.drive.torque_constant_Nm_per_A) {}

double DriveScale::of(ObjectKind kind) const {
  switch (kind) {
    case ObjectKind::kCounts:
      return rad_per_count;
    case ObjectKind::kLinkCounts:
      return link_rad_per_count;
    case ObjectKind::kPermilleTorque:
      return rated_torque_Nm / 1000.0;
    case ObjectKind::kPermilleCurrent:
      return rated_current_A / 1000.0;
    default:
      return 1.0;
  }
}

bool is_signed(ObjectKind kind) {
  switch (kind) {
    case ObjectKind::kSigned:
    case ObjectKind::kCounts:
    case ObjectKind::kLinkCounts:
    case ObjectKind::kPermilleTorque:
    case ObjectKind::kPermilleCurrent:
      return true;
    default:
      return false;
  }
}

Value object_value(ObjectId id, std::uint32_t raw, int bytes, const DriveScale& scale) {
  if (bytes <= 0 || bytes > 4) bytes = 4;
  const ObjectRow row = object_row(id);
  const auto word = static_cast<std::uint16_t>(raw);
  switch (row.kind) {
    case ObjectKind::kControlword:
      return {row.name, hex(word, 4) + "h (" + command_word(word) + ")", ""};
    case ObjectKind::kStatusword:
      return {row.name, hex(word, 4) + "h (" + cia402::name_of(cia402::state_of(word)) + ")", ""};
    case ObjectKind::kBits:
      return {row.name, hex(raw, 2 * bytes) + "h", ""};
    case ObjectKind::kMapping:
      return {row.name, mapping_text(raw), ""};
    case ObjectKind::kFloat:
      return {row.name, number(static_cast<double>(mit::bits_float(raw))), row.unit};
    case ObjectKind::kUnsigned:
      return {row.name, std::to_string(raw), row.unit};
    case ObjectKind::kSigned:
      return {row.name, std::to_string(extended(raw, bytes)), row.unit};
    default:
      return {row.name, number(scale.of(row.kind) * extended(raw, bytes)), row.unit};
  }
}

}  // namespace limber::bus_tools
