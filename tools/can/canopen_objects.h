// Names and units of the objects of CiA 301 and CiA 402 that one meets on limber's buses.
#pragma once

#include <cstdint>
#include <string>

#include "drivers/protocols/canopen.h"
#include "tools/can/motors_on_bus.h"
#include "tools/can/reading.h"

namespace limber::bus_tools {

/// How the number in an object is to be read.
enum class ObjectKind : std::uint8_t {
  kUnsigned,
  kSigned,
  kFloat,
  kBits,  ///< shown in hexadecimal
  kControlword,
  kStatusword,
  kCounts,           ///< of the motor's encoder, rad or rad/s
  kLinkCounts,       ///< of the link's encoder
  kPermilleTorque,   ///< of the rated torque
  kPermilleCurrent,  ///< of the rated current
  kMapping,          ///< index, subindex and bits of another object
};

struct ObjectRow {
  std::string name;
  ObjectKind kind = ObjectKind::kBits;
  std::string unit;  ///< once scaled
};

/// "object 2005h:01" for those without a name.
ObjectRow object_row(canopen::ObjectId id);
/// "6041h:00"
std::string object_number(canopen::ObjectId id);

/// What the counts of one drive are worth.
struct DriveScale {
  explicit DriveScale(const Motor& motor, double rad_per_count);

  double rad_per_count;
  double link_rad_per_count;
  double rated_torque_Nm;
  double rated_current_A;

  /// Units of the row per count; 1 for plain numbers.
  double of(ObjectKind kind) const;
};

bool is_signed(ObjectKind kind);

/// The object's value, from the low `bytes` of `raw`.
Value object_value(canopen::ObjectId id, std::uint32_t raw, int bytes, const DriveScale& scale);

}  // namespace limber::bus_tools
