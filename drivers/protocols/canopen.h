// The communication services of CANopen as bytes (CiA 301): identifiers, network management,
// heartbeat, SYNC, emergency, contents of PDOs. SDO is in canopen_sdo.h. Both directions, no I/O,
// no state; everything is allowed in the cycle.
#pragma once

#include <array>
#include <cstdint>

#include "drivers/can/can_frame.h"

#pragma GCC visibility push(default)
namespace limber::canopen {

// Identifiers of the predefined connection set. Those of a node: code + node number, 1 to 127.
inline constexpr std::uint32_t kNmtId = 0x000;
inline constexpr std::uint32_t kSyncId = 0x080;
inline constexpr std::uint32_t kEmergencyCode = 0x080;
inline constexpr std::uint32_t kTpdo1Code = 0x180;  ///< the next ones kPdoStep apart
inline constexpr std::uint32_t kRpdo1Code = 0x200;  ///< likewise
inline constexpr std::uint32_t kPdoStep = 0x100;
inline constexpr int kPdos = 4;  ///< each way
inline constexpr std::uint32_t kSdoAnswerCode = 0x580;
inline constexpr std::uint32_t kSdoRequestCode = 0x600;
inline constexpr std::uint32_t kHeartbeatCode = 0x700;

/// Of TPDO k = 0 to 3.
constexpr std::uint32_t tpdo_id(int k, std::uint8_t node) noexcept {
  return kTpdo1Code + kPdoStep * static_cast<std::uint32_t>(k) + node;
}
constexpr std::uint8_t node_of(std::uint32_t id) noexcept {
  return static_cast<std::uint8_t>(id & 0x7FU);
}

/// A place in the object dictionary.
struct ObjectId {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;

  /// index << 8 | sub: as StartupStep::reg counts.
  constexpr std::uint32_t number() const noexcept {
    return static_cast<std::uint32_t>(index) << 8U | sub;
  }
  constexpr bool operator==(const ObjectId&) const noexcept = default;
};

/// A place in the object dictionary with its length.
struct Object {
  ObjectId id;
  std::uint8_t bytes = 0;  ///< 1, 2 or 4; longer ones travel in segments and fit no PDO

  /// Entry of a PDO mapping: index << 16 | sub << 8 | length in bits.
  constexpr std::uint32_t mapping() const noexcept { return id.number() << 8U | bytes * 8U; }
};

// Objects of every node. Communication and mapping records of PDO k = 0, 1, ..
inline constexpr Object kDeviceType = {{0x1000, 0}, 4};
inline constexpr Object kErrorRegister = {{0x1001, 0}, 1};
inline constexpr Object kErrorCount = {{0x1003, 0}, 1};  ///< the errors follow, latest first
inline constexpr Object kSyncCobId = {{0x1005, 0}, 4};
/// 0: SYNC has no counter.
inline constexpr Object kSyncCounterOverflow = {{0x1019, 0}, 1};
/// What a communication error does: 0 to pre-operational, 1 nothing, 2 to stopped.
inline constexpr Object kErrorBehaviour = {{0x1029, 1}, 1};
inline constexpr Object kHeartbeatPeriod_ms = {{0x1017, 0}, 2};
/// node << 16 | time-out in ms.
inline constexpr Object kConsumerHeartbeat = {{0x1016, 1}, 4};
inline constexpr std::uint16_t kRpdoCommunication = 0x1400;
inline constexpr std::uint16_t kRpdoMapping = 0x1600;
inline constexpr std::uint16_t kTpdoCommunication = 0x1800;
inline constexpr std::uint16_t kTpdoMapping = 0x1A00;
constexpr Object pdo_cob_id(std::uint16_t record) noexcept { return {{record, 1}, 4}; }
constexpr Object pdo_type(std::uint16_t record) noexcept { return {{record, 2}, 1}; }
/// In 100 us; TPDO on change only.
constexpr Object pdo_inhibit_time(std::uint16_t record) noexcept { return {{record, 3}, 2}; }
/// Of an RPDO: reception time-out; 0: none.
constexpr Object pdo_event_timer_ms(std::uint16_t record) noexcept { return {{record, 5}, 2}; }
constexpr Object pdo_mapped_count(std::uint16_t mapping) noexcept { return {{mapping, 0}, 1}; }
/// i = 1, 2, ..: Object::mapping() of what lies there.
constexpr Object pdo_mapped(std::uint16_t mapping, int i) noexcept {
  return {{mapping, static_cast<std::uint8_t>(i)}, 4};
}
inline constexpr std::uint32_t kPdoDisabled = 1U << 31U;  ///< in a PDO's COB-ID
inline constexpr std::uint8_t kLastSynchronousType = 240;
inline constexpr std::uint8_t kAtOnce = 255;

// --- network management --------------------------------------------------------------------------

enum class NmtCommand : std::uint8_t {
  kStart = 0x01,
  kStop = 0x02,
  kPreOperational = 0x80,
  kResetNode = 0x81,
  kResetCommunication = 0x82,
};
/// As in a heartbeat. Pre-operational: SDO, no PDO; operational: both; stopped: neither.
enum class NmtState : std::uint8_t {
  kBootUp = 0x00,
  kStopped = 0x04,
  kOperational = 0x05,
  kPreOperational = 0x7F,
};

/// `node` 0: all nodes.
CanFrame encode_nmt(NmtCommand command, std::uint8_t node) noexcept;
/// False unless it is a command that exists, for this node or for all.
[[nodiscard]] bool decode_nmt(const CanFrame& frame, std::uint8_t node,
                              NmtCommand* command) noexcept;

CanFrame encode_heartbeat(NmtState state, std::uint8_t node) noexcept;
/// False unless it is a heartbeat (or boot-up) of this node, with a state that exists.
[[nodiscard]] bool decode_heartbeat(const CanFrame& frame, std::uint8_t node,
                                    NmtState* state) noexcept;

CanFrame encode_sync() noexcept;
/// With a counter, 1 to the overflow value of 1019h.
CanFrame encode_sync(std::uint8_t counter) noexcept;

// --- emergency -----------------------------------------------------------------------------------

struct Emergency {
  std::uint16_t code = 0;           ///< 0: all errors are gone
  std::uint8_t error_register = 0;  ///< kError... bits
  std::array<std::uint8_t, 5> vendor{};
};
inline constexpr std::uint8_t kErrorGeneric = 1U << 0U;
inline constexpr std::uint8_t kErrorCurrent = 1U << 1U;
inline constexpr std::uint8_t kErrorCommunication = 1U << 4U;

inline constexpr std::uint16_t kOverCurrent = 0x2310;
inline constexpr std::uint16_t kDriveTooHot = 0x4310;
inline constexpr std::uint16_t kCommunicationError = 0x8100;
inline constexpr std::uint16_t kHeartbeatLost = 0x8130;
inline constexpr std::uint16_t kPdoTooShort = 0x8210;
inline constexpr std::uint16_t kSyncLength = 0x8240;
inline constexpr std::uint16_t kRpdoTimeout = 0x8250;

/// A code in words: its own, or those of its class. Never nullptr.
const char* emergency_text(std::uint16_t code) noexcept;
CanFrame encode_emergency(const Emergency& emergency, std::uint8_t node) noexcept;
[[nodiscard]] bool decode_emergency(const CanFrame& frame, std::uint8_t node,
                                    Emergency* emergency) noexcept;

// --- contents of PDOs: little-endian fields one behind the other
// -----------------------------------

class FieldWriter {
 public:
  /// `fd`: an FD frame with bit-rate switch, padded with zeros to a length that FD has.
  FieldWriter(std::uint32_t id, bool fd) noexcept;
  /// The low `bytes` (1 to 4) of the value; nothing if the frame has no room for them.
  void put(std::uint32_t value, int bytes) noexcept;
  CanFrame frame() const noexcept;

 private:
  CanFrame frame_;
};

/// The frame outlives the reader.
class FieldReader {
 public:
  explicit FieldReader(const CanFrame& frame) noexcept : frame_(frame) {}
  /// Zero-extended; 0 and complete() false from there on if the frame is too short.
  std::uint32_t take(int bytes) noexcept;
  std::int32_t take_signed(int bytes) noexcept;
  bool complete() const noexcept { return complete_; }

 private:
  const CanFrame& frame_;
  int at_ = 0;
  bool complete_ = true;
};

}  // namespace limber::canopen
#pragma GCC visibility pop
