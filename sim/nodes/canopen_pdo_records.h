// How the PDOs of an emulated CANopen node are configured: their records in the object dictionary,
// and what SDO may write there.
#pragma once

#include <array>
#include <cstdint>

#include "sim/nodes/canopen_dictionary.h"

namespace limber::sim {

/// Longer PDOs are FD frames.
inline constexpr int kClassicBytes = 8;
/// Transmission types from here on: when the application has something new.
inline constexpr int kOnEvent = 254;

/// One PDO as its records have it.
struct PdoSettings {
  static constexpr int kMostMapped = 16;

  bool enabled = false;
  std::uint32_t id = 0;
  int type = 0;
  std::int64_t inhibit_ns = 0;
  std::int64_t timer_ns = 0;
  int count = 0;
  int bytes = 0;                                    ///< of all that is mapped
  std::array<std::uint32_t, kMostMapped> mapped{};  ///< as in the mapping record
};

/// Parts of a mapping entry.
inline canopen::ObjectId mapped_object(std::uint32_t entry) noexcept {
  return {static_cast<std::uint16_t>(entry >> 16U), static_cast<std::uint8_t>(entry >> 8U)};
}
inline int mapped_length(std::uint32_t entry) noexcept {
  return static_cast<int>((entry & 0xFFU) / 8U);
}

/// Four PDOs each way, up to 16 objects each, eight bytes on a classic bus and 64 on an FD one.
/// RPDOs may carry dummy objects (0002h to 0007h). After construction every member is allowed in
/// the cycle.
class CanopenPdoRecords {
 public:
  static constexpr int kPdos = canopen::kPdos;

  CanopenPdoRecords(CanopenDictionary* dictionary, std::uint8_t node, bool fd);

  /// Whether the index is one of a PDO's records.
  static bool is_record(std::uint16_t index) noexcept;
  /// What CiA 301 allows in a record: identifier and type in pre-operational; the mapping there,
  /// too, while its PDO is disabled and the mapping counts no objects.
  Refusal refuses(const DictionaryEntry& entry, double value, bool pre_operational) noexcept;
  /// Of PDO k = 0 to 3.
  PdoSettings rpdo(int k) noexcept;
  PdoSettings tpdo(int k) noexcept;

 private:
  void add_objects(std::uint8_t node);
  Refusal refuses_mapped(canopen::ObjectId id, std::uint32_t value) noexcept;
  Refusal refuses_count(std::uint16_t mapping, int count) noexcept;
  Refusal refuses_cob_id(std::uint16_t record, std::uint32_t value) noexcept;
  bool enabled(std::uint16_t record) noexcept;
  std::uint32_t entry(std::uint16_t mapping, int i) noexcept;
  int mapped_bytes(std::uint16_t mapping, int count) noexcept;
  PdoSettings settings(std::uint16_t communication, std::uint16_t mapping) noexcept;

  CanopenDictionary* dictionary_;
  bool fd_;
};

}  // namespace limber::sim
