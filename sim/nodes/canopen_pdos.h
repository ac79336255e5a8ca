// The PDOs of an emulated CANopen node: what may be configured over SDO, and what travels when.
#pragma once

#include <array>
#include <cstdint>

#include "drivers/can/can_frame.h"
#include "sim/nodes/canopen_dictionary.h"

namespace limber::sim {

/// Four PDOs each way, up to 16 objects each, eight bytes on a classic bus and 64 on an FD one.
/// RPDOs may carry dummy objects (0002h to 0007h). After construction every member is allowed in
/// the cycle.
class CanopenPdos {
 public:
  enum class Heard : std::uint8_t { kNothing, kTaken, kTooShort };

  CanopenPdos(CanopenDictionary* dictionary, std::uint8_t node, bool fd);

  /// Whether the index is one of a PDO's records.
  static bool is_record(std::uint16_t index) noexcept;
  /// What CiA 301 allows in a record: identifier and type in pre-operational; the mapping there,
  /// too, while its PDO is disabled and the mapping counts no objects.
  Refusal refuses(const DictionaryEntry& entry, double value, bool pre_operational) noexcept;

  // Operational only.
  /// Takes an RPDO in: at once, or (types 0 to 240) until apply().
  Heard receive(const CanFrame& frame, std::int64_t now_ns) noexcept;
  /// At a SYNC: the synchronous RPDOs take effect.
  void apply() noexcept;
  /// Whether TPDO k = 0 to 3 is due at this SYNC; counts it.
  bool due_at_sync(int k, CanFrame* frame) noexcept;
  /// Whether TPDO k is one that goes without a SYNC.
  bool awaits_event(int k) noexcept;
  /// Whether it goes now: its contents have changed, or its event timer has run off.
  bool due_on_event(int k, std::int64_t now_ns, CanFrame* frame) noexcept;
  /// True once when an RPDO that has an event timer has not come for that long.
  bool timed_out(std::int64_t now_ns) noexcept;
  /// Entering operational: nothing heard or sent so far.
  void restart() noexcept;

  static constexpr int kPdos = 4;

 private:
  static constexpr int kMostMapped = 16;
  struct Rpdo {
    bool waiting = false;  ///< for a SYNC
    bool watched = false;
    std::int64_t heard_ns = 0;
    CanFrame frame;
  };
  struct Tpdo {
    bool sent = false;
    int syncs = 0;
    std::int64_t sent_ns = 0;
    CanFrame frame;
  };

  void add_objects(std::uint8_t node);
  Refusal refuses_mapped(canopen::ObjectId id, std::uint32_t value) noexcept;
  Refusal refuses_count(std::uint16_t mapping, int count) noexcept;
  Refusal refuses_cob_id(std::uint16_t record, std::uint32_t value) noexcept;
  bool enabled(std::uint16_t record) noexcept;
  std::uint32_t entry(std::uint16_t mapping, int i) noexcept;
  int mapped_bytes(std::uint16_t mapping, int count) noexcept;
  void unpack(int k, const CanFrame& frame) noexcept;
  CanFrame pack(int k) noexcept;
  bool changed(int k, const CanFrame& frame) const noexcept;
  void sent(int k, const CanFrame& frame, std::int64_t now_ns) noexcept;

  CanopenDictionary* dictionary_;
  bool fd_;
  std::array<Rpdo, kPdos> rpdos_;
  std::array<Tpdo, kPdos> tpdos_;
};

}  // namespace limber::sim
