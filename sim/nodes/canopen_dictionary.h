// The object dictionary of an emulated CANopen node: every value that SDO and PDO can reach.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/protocols/canopen.h"
#include "drivers/protocols/canopen_sdo.h"

namespace limber::sim {

enum class ValueType : std::uint8_t { kU8, kI8, kU16, kI16, kU32, kI32, kFloat, kText };
enum class Access : std::uint8_t { kReadOnly, kReadWrite };
enum class Mapping : std::uint8_t { kNo, kYes };

/// Why something is not done; nothing: it is done.
using Refusal = std::optional<canopen::SdoAbort>;

struct DictionaryEntry {
  static constexpr std::size_t kLongest = 32;

  canopen::ObjectId id;
  ValueType type = ValueType::kU32;
  Access access = Access::kReadOnly;
  Mapping mapping = Mapping::kNo;
  double min = 0.0;  ///< what may be written
  double max = 0.0;
  std::array<std::uint8_t, kLongest> data{};  ///< little-endian
  std::uint8_t length = 0;

  std::span<const std::uint8_t> bytes() const noexcept { return {data.data(), length}; }
  /// Not for texts.
  double value() const noexcept;
  /// Rounded towards zero; what an integer does not hold wraps around, as counters do.
  void set(double value) noexcept;
};

/// Has a word in what is written, after access, length and range have been found right.
class DictionaryGuard {
 public:
  virtual ~DictionaryGuard() = default;
  virtual Refusal refuses(const DictionaryEntry& entry, double value) noexcept = 0;
  virtual void on_written(canopen::ObjectId id) noexcept = 0;
};

/// Filled at set-up, then closed; from there on every member is allowed in the cycle.
class CanopenDictionary {
 public:
  /// Numbers. `object` and `type` agree in length.
  void add(const canopen::Object& object, ValueType type, double value, Access access,
           Mapping mapping);
  /// The same, read and written, within what it may be.
  void add_writable(const canopen::Object& object, ValueType type, double value, double min,
                    double max, Mapping mapping = Mapping::kNo);
  void add_text(canopen::ObjectId id, const std::string& text, Access access);
  /// Values as they are now are those of power-on.
  void close(DictionaryGuard* guard);

  /// nullptr: there is none; absence() gives the reason.
  DictionaryEntry* find(canopen::ObjectId id) noexcept;
  canopen::SdoAbort absence(canopen::ObjectId id) const noexcept;
  /// Of numbers that exist.
  double value(canopen::ObjectId id) noexcept { return find(id)->value(); }
  double value(const canopen::Object& object) noexcept { return value(object.id); }
  void set(const canopen::Object& object, double value) noexcept { find(object.id)->set(value); }

  /// From outside, through SDO or PDO.
  Refusal write(DictionaryEntry* entry, std::span<const std::uint8_t> bytes) noexcept;
  /// Power-on values for the indices from `first` to `last`.
  void reset(std::uint16_t first, std::uint16_t last) noexcept;

 private:
  std::vector<DictionaryEntry> entries_;  // by number
  std::vector<std::uint32_t> numbers_;    // of the entries: near to one another, to be searched
  std::vector<DictionaryEntry> power_on_;
  DictionaryGuard* guard_ = nullptr;
};

}  // namespace limber::sim
