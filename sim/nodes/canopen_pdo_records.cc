#include "sim/nodes/canopen_pdo_records.h"

namespace limber::sim {
namespace {

using canopen::ObjectId;
using canopen::SdoAbort;

constexpr std::uint32_t kNoRtr = 1U << 30U;
constexpr std::uint32_t kLongId = 1U << 29U;
constexpr std::uint32_t kFirstPdoId = 0x181;
constexpr std::uint32_t kLastPdoId = 0x57F;
constexpr int kFdBytes = 64;
constexpr std::int64_t kInhibitUnit_ns = 100'000;
constexpr std::int64_t kMs = 1'000'000;

std::uint16_t record_of(std::uint16_t first, int k) noexcept {
  return static_cast<std::uint16_t>(first + k);
}

/// Bits that a dummy object stands for; 0: none.
unsigned dummy_bits(ObjectId id) noexcept {
  constexpr std::array<unsigned, 8> kBits = {0, 0, 8, 16, 32, 8, 16, 32};
  return id.sub == 0 && id.index < kBits.size() ? kBits[id.index] : 0;
}

bool is_mapping(std::uint16_t index) noexcept {
  return (index & 0xFE00U) == canopen::kRpdoMapping || (index & 0xFE00U) == canopen::kTpdoMapping;
}

bool is_rpdo(std::uint16_t index) noexcept { return index < canopen::kTpdoCommunication; }

}  // namespace

CanopenPdoRecords::CanopenPdoRecords(CanopenDictionary* dictionary, std::uint8_t node, bool fd)
    : dictionary_(dictionary), fd_(fd) {
  add_objects(node);
}

void CanopenPdoRecords::add_objects(std::uint8_t node) {
  using enum ValueType;
  const auto add_records = [&](std::uint16_t communication, std::uint16_t mapping,
                               std::uint32_t cob_id) {
    dictionary_->add({{communication, 0}, 1}, kU8, 5, Access::kReadOnly, Mapping::kNo);
    dictionary_->add_writable(canopen::pdo_cob_id(communication), kU32,
                              cob_id | canopen::kPdoDisabled, 0, 0xFFFFFFFF);
    dictionary_->add_writable(canopen::pdo_type(communication), kU8, canopen::kAtOnce, 0, 255);
    dictionary_->add_writable(canopen::pdo_inhibit_time(communication), kU16, 0, 0, 65535);
    dictionary_->add_writable(canopen::pdo_event_timer_ms(communication), kU16, 0, 0, 65535);
    dictionary_->add_writable(canopen::pdo_mapped_count(mapping), kU8, 0, 0,
                              PdoSettings::kMostMapped);
    for (int i = 1; i <= PdoSettings::kMostMapped; ++i)
      dictionary_->add_writable(canopen::pdo_mapped(mapping, i), kU32, 0, 0, 0xFFFFFFFF);
  };
  for (int k = 0; k < kPdos; ++k) {
    const std::uint32_t offset = 0x100U * static_cast<unsigned>(k) + node;
    add_records(record_of(canopen::kRpdoCommunication, k), record_of(canopen::kRpdoMapping, k),
                canopen::kRpdo1Code + offset);
    add_records(record_of(canopen::kTpdoCommunication, k), record_of(canopen::kTpdoMapping, k),
                canopen::kTpdo1Code + offset);
  }
}

bool CanopenPdoRecords::is_record(std::uint16_t index) noexcept {
  return index >= canopen::kRpdoCommunication && index < canopen::kTpdoMapping + 0x200;
}

Refusal CanopenPdoRecords::refuses(const DictionaryEntry& entry, double value,
                                   bool pre_operational) noexcept {
  const ObjectId id = entry.id;
  const bool timer = !is_mapping(id.index) && id.sub > 2;
  if (timer) return {};
  if (!pre_operational) return SdoAbort::kWrongState;
  if (is_mapping(id.index)) {
    const auto communication = static_cast<std::uint16_t>(id.index - 0x200);
    if (enabled(communication)) return SdoAbort::kWrongState;
    return id.sub == 0 ? refuses_count(id.index, static_cast<int>(value))
                       : refuses_mapped(id, static_cast<std::uint32_t>(value));
  }
  if (id.sub == 1) return refuses_cob_id(id.index, static_cast<std::uint32_t>(value));
  const bool type_exists = value <= canopen::kLastSynchronousType || value >= kOnEvent;
  return type_exists ? Refusal{} : SdoAbort::kValueRange;
}

Refusal CanopenPdoRecords::refuses_cob_id(std::uint16_t record, std::uint32_t value) noexcept {
  const std::uint32_t id = value & ~(canopen::kPdoDisabled | kNoRtr);
  const bool stays_disabled = (value & canopen::kPdoDisabled) != 0;
  if ((value & kLongId) != 0) return SdoAbort::kValueRange;
  if (!stays_disabled && (id < kFirstPdoId || id > kLastPdoId)) return SdoAbort::kValueRange;
  const auto present = static_cast<std::uint32_t>(dictionary_->value(canopen::pdo_cob_id(record)));
  if (enabled(record) && !stays_disabled && value != present) return SdoAbort::kWrongState;
  return {};
}

Refusal CanopenPdoRecords::refuses_mapped(ObjectId id, std::uint32_t value) noexcept {
  if (dictionary_->value(canopen::pdo_mapped_count(id.index)) != 0.0) return SdoAbort::kWrongState;
  const unsigned bits = value & 0xFFU;
  const ObjectId wanted = mapped_object(value);
  if (dummy_bits(wanted) != 0)
    return is_rpdo(id.index) && bits == dummy_bits(wanted) ? Refusal{} : SdoAbort::kNotMappable;
  const DictionaryEntry* object = dictionary_->find(wanted);
  if (object == nullptr) return dictionary_->absence(wanted);
  const bool fits = object->mapping == Mapping::kYes && bits == 8U * object->length &&
                    (!is_rpdo(id.index) || object->access == Access::kReadWrite);
  return fits ? Refusal{} : SdoAbort::kNotMappable;
}

Refusal CanopenPdoRecords::refuses_count(std::uint16_t mapping, int count) noexcept {
  for (int i = 1; i <= count; ++i) {
    if (entry(mapping, i) == 0) return SdoAbort::kNotMappable;
  }
  return mapped_bytes(mapping, count) > (fd_ ? kFdBytes : kClassicBytes) ? SdoAbort::kPdoTooLong
                                                                         : Refusal{};
}

bool CanopenPdoRecords::enabled(std::uint16_t record) noexcept {
  const auto cob_id = static_cast<std::uint32_t>(dictionary_->value(canopen::pdo_cob_id(record)));
  return (cob_id & canopen::kPdoDisabled) == 0;
}

std::uint32_t CanopenPdoRecords::entry(std::uint16_t mapping, int i) noexcept {
  return static_cast<std::uint32_t>(dictionary_->value(canopen::pdo_mapped(mapping, i)));
}

int CanopenPdoRecords::mapped_bytes(std::uint16_t mapping, int count) noexcept {
  int bytes = 0;
  for (int i = 1; i <= count; ++i) bytes += mapped_length(entry(mapping, i));
  return bytes;
}

PdoSettings CanopenPdoRecords::settings(std::uint16_t communication,
                                        std::uint16_t mapping) noexcept {
  PdoSettings out;
  const auto value = [this](const canopen::Object& object) { return dictionary_->value(object); };
  out.enabled = enabled(communication);
  out.id = static_cast<std::uint32_t>(value(canopen::pdo_cob_id(communication))) &
           ~(canopen::kPdoDisabled | kNoRtr);
  out.type = static_cast<int>(value(canopen::pdo_type(communication)));
  out.inhibit_ns =
      static_cast<std::int64_t>(value(canopen::pdo_inhibit_time(communication))) * kInhibitUnit_ns;
  out.timer_ns = static_cast<std::int64_t>(value(canopen::pdo_event_timer_ms(communication))) * kMs;
  out.count = static_cast<int>(value(canopen::pdo_mapped_count(mapping)));
  out.bytes = mapped_bytes(mapping, out.count);
  for (int i = 0; i < out.count; ++i)
    out.mapped[static_cast<std::size_t>(i)] = entry(mapping, i + 1);
  return out;
}

PdoSettings CanopenPdoRecords::rpdo(int k) noexcept {
  return settings(record_of(canopen::kRpdoCommunication, k), record_of(canopen::kRpdoMapping, k));
}

PdoSettings CanopenPdoRecords::tpdo(int k) noexcept {
  return settings(record_of(canopen::kTpdoCommunication, k), record_of(canopen::kTpdoMapping, k));
}

}  // namespace limber::sim
