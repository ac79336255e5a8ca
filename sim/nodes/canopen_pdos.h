// The PDOs of an emulated CANopen node at work: what travels when.
#pragma once

#include <array>
#include <cstdint>

#include "drivers/can/can_frame.h"
#include "sim/nodes/canopen_dictionary.h"
#include "sim/nodes/canopen_pdo_records.h"

namespace limber::sim {

/// All but load() for operational nodes only. After construction every member is allowed in the
/// cycle.
class CanopenPdos {
 public:
  static constexpr int kPdos = CanopenPdoRecords::kPdos;
  enum class Heard : std::uint8_t { kNothing, kTaken, kTooShort };

  CanopenPdos(CanopenDictionary* dictionary, bool fd) : dictionary_(dictionary), fd_(fd) {}

  /// Copies the records; call after each write to one.
  void load(CanopenPdoRecords* records) noexcept;
  /// Nothing heard or sent so far.
  void restart() noexcept;

  /// Takes an RPDO in: at once, or (types 0 to 240) until apply().
  Heard receive(const CanFrame& frame, std::int64_t now_ns) noexcept;
  /// At a SYNC: the synchronous RPDOs take effect.
  void apply() noexcept;
  /// True once when an RPDO that has an event timer has not come for that long.
  bool timed_out(std::int64_t now_ns) noexcept;
  /// Whether TPDO k = 0 to 3 is due at this SYNC; counts it.
  bool due_at_sync(int k, CanFrame* frame) noexcept;
  /// Whether TPDO k is one that goes without a SYNC.
  bool awaits_event(int k) const noexcept;
  /// Whether it goes now: its contents have changed, or its event timer has run off.
  bool due_on_event(int k, std::int64_t now_ns, CanFrame* frame) noexcept;

 private:
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

  void unpack(const PdoSettings& pdo, const CanFrame& frame) noexcept;
  CanFrame pack(const PdoSettings& pdo) noexcept;
  bool changed(int k, const CanFrame& frame) const noexcept;

  CanopenDictionary* dictionary_;
  bool fd_;
  std::array<PdoSettings, kPdos> rpdo_settings_;
  std::array<PdoSettings, kPdos> tpdo_settings_;
  std::array<Rpdo, kPdos> rpdos_;
  std::array<Tpdo, kPdos> tpdos_;
};

}  // namespace limber::sim
