#include "sim/nodes/canopen_pdos.h"

#include <algorithm>

namespace limber::sim {
namespace {

using canopen::FieldReader;
using canopen::FieldWriter;
using canopen::ObjectId;
using canopen::SdoAbort;

constexpr std::uint32_t kNoRtr = 1U << 30U;
constexpr std::uint32_t kLongId = 1U << 29U;
constexpr std::uint32_t kFirstPdoId = 0x181;
constexpr std::uint32_t kLastPdoId = 0x57F;
constexpr std::uint8_t kOnEvent = 254;
constexpr int kClassicBytes = 8;
constexpr int kFdBytes = 64;
constexpr std::int64_t kInhibitUnit_ns = 100'000;
constexpr std::int64_t kMs = 1'000'000;

std::uint16_t record_of(std::uint16_t first, int k) noexcept {
  return static_cast<std::uint16_t>(first + k);
}

/// Parts of a mapping entry.
ObjectId object_of(std::uint32_t entry) noexcept {
  return {static_cast<std::uint16_t>(entry >> 16U), static_cast<std::uint8_t>(entry >> 8U)};
}
int bytes_of(std::uint32_t entry) noexcept { return static_cast<int>((entry & 0xFFU) / 8U); }

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

// --- configuration -------------------------------------------------------------------------------

CanopenPdos::CanopenPdos(CanopenDictionary* dictionary, std::uint8_t node, bool fd)
    : dictionary_(dictionary), fd_(fd) {
  add_objects(node);
}

void CanopenPdos::add_objects(std::uint8_t node) {
  using enum ValueType;
  const auto add_records = [&](std::uint16_t communication, std::uint16_t mapping,
                               std::uint32_t cob_id) {
    dictionary_->add({{communication, 0}, 1}, kU8, 5, Access::kReadOnly, Mapping::kNo);
    dictionary_->add_writable(canopen::pdo_cob_id(communication), kU32,
                              cob_id | canopen::kPdoDisabled, 0, 0xFFFFFFFF);
    dictionary_->add_writable(canopen::pdo_type(communication), kU8, canopen::kAtOnce, 0, 255);
    dictionary_->add_writable(canopen::pdo_inhibit_time(communication), kU16, 0, 0, 65535);
    dictionary_->add_writable(canopen::pdo_event_timer_ms(communication), kU16, 0, 0, 65535);
    dictionary_->add_writable(canopen::pdo_mapped_count(mapping), kU8, 0, 0, kMostMapped);
    for (int i = 1; i <= kMostMapped; ++i)
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

bool CanopenPdos::is_record(std::uint16_t index) noexcept {
  return index >= canopen::kRpdoCommunication && index < canopen::kTpdoMapping + 0x200;
}

Refusal CanopenPdos::refuses(const DictionaryEntry& entry, double value,
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

Refusal CanopenPdos::refuses_cob_id(std::uint16_t record, std::uint32_t value) noexcept {
  const std::uint32_t id = value & ~(canopen::kPdoDisabled | kNoRtr);
  const bool stays_disabled = (value & canopen::kPdoDisabled) != 0;
  if ((value & kLongId) != 0) return SdoAbort::kValueRange;
  if (!stays_disabled && (id < kFirstPdoId || id > kLastPdoId)) return SdoAbort::kValueRange;
  const auto present = static_cast<std::uint32_t>(dictionary_->value(canopen::pdo_cob_id(record)));
  if (enabled(record) && !stays_disabled && value != present) return SdoAbort::kWrongState;
  return {};
}

Refusal CanopenPdos::refuses_mapped(ObjectId id, std::uint32_t value) noexcept {
  if (dictionary_->value(canopen::pdo_mapped_count(id.index)) != 0.0) return SdoAbort::kWrongState;
  const unsigned bits = value & 0xFFU;
  const ObjectId wanted = object_of(value);
  if (dummy_bits(wanted) != 0)
    return is_rpdo(id.index) && bits == dummy_bits(wanted) ? Refusal{} : SdoAbort::kNotMappable;
  const DictionaryEntry* object = dictionary_->find(wanted);
  if (object == nullptr) return dictionary_->absence(wanted);
  const bool fits = object->mapping == Mapping::kYes && bits == 8U * object->length &&
                    (!is_rpdo(id.index) || object->access == Access::kReadWrite);
  return fits ? Refusal{} : SdoAbort::kNotMappable;
}

Refusal CanopenPdos::refuses_count(std::uint16_t mapping, int count) noexcept {
  for (int i = 1; i <= count; ++i) {
    if (entry(mapping, i) == 0) return SdoAbort::kNotMappable;
  }
  return mapped_bytes(mapping, count) > (fd_ ? kFdBytes : kClassicBytes) ? SdoAbort::kPdoTooLong
                                                                         : Refusal{};
}

bool CanopenPdos::enabled(std::uint16_t record) noexcept {
  const auto cob_id = static_cast<std::uint32_t>(dictionary_->value(canopen::pdo_cob_id(record)));
  return (cob_id & canopen::kPdoDisabled) == 0;
}

std::uint32_t CanopenPdos::entry(std::uint16_t mapping, int i) noexcept {
  return static_cast<std::uint32_t>(dictionary_->value(canopen::pdo_mapped(mapping, i)));
}

int CanopenPdos::mapped_bytes(std::uint16_t mapping, int count) noexcept {
  int bytes = 0;
  for (int i = 1; i <= count; ++i) bytes += bytes_of(entry(mapping, i));
  return bytes;
}

// --- RPDOs ---------------------------------------------------------------------------------------

CanopenPdos::Heard CanopenPdos::receive(const CanFrame& frame, std::int64_t now_ns) noexcept {
  Heard heard = Heard::kNothing;
  for (int k = 0; k < kPdos; ++k) {
    const std::uint16_t record = record_of(canopen::kRpdoCommunication, k);
    const auto cob_id = static_cast<std::uint32_t>(dictionary_->value(canopen::pdo_cob_id(record)));
    if ((cob_id & canopen::kPdoDisabled) != 0 || !has_id(frame, cob_id & ~kNoRtr) || frame.remote)
      continue;
    const std::uint16_t mapping = record_of(canopen::kRpdoMapping, k);
    const auto count = static_cast<int>(dictionary_->value(canopen::pdo_mapped_count(mapping)));
    if (frame.length < mapped_bytes(mapping, count)) return Heard::kTooShort;
    Rpdo& rpdo = rpdos_[static_cast<std::size_t>(k)];
    rpdo.watched = true;
    rpdo.heard_ns = now_ns;
    rpdo.waiting = dictionary_->value(canopen::pdo_type(record)) <= canopen::kLastSynchronousType;
    if (rpdo.waiting)
      rpdo.frame = frame;
    else
      unpack(k, frame);
    heard = Heard::kTaken;
  }
  return heard;
}

void CanopenPdos::apply() noexcept {
  for (int k = 0; k < kPdos; ++k) {
    Rpdo& rpdo = rpdos_[static_cast<std::size_t>(k)];
    if (rpdo.waiting) unpack(k, rpdo.frame);
    rpdo.waiting = false;
  }
}

void CanopenPdos::unpack(int k, const CanFrame& frame) noexcept {
  const std::uint16_t mapping = record_of(canopen::kRpdoMapping, k);
  const auto count = static_cast<int>(dictionary_->value(canopen::pdo_mapped_count(mapping)));
  std::size_t at = 0;
  for (int i = 1; i <= count; ++i) {
    const std::uint32_t mapped = entry(mapping, i);
    const auto bytes = static_cast<std::size_t>(bytes_of(mapped));
    DictionaryEntry* object = dictionary_->find(object_of(mapped));
    // A dummy has no entry; a value that the dictionary refuses changes nothing.
    if (object != nullptr)
      static_cast<void>(dictionary_->write(object, {frame.data.data() + at, bytes}));
    at += bytes;
  }
}

bool CanopenPdos::timed_out(std::int64_t now_ns) noexcept {
  bool timed_out = false;
  for (int k = 0; k < kPdos; ++k) {
    Rpdo& rpdo = rpdos_[static_cast<std::size_t>(k)];
    const std::uint16_t record = record_of(canopen::kRpdoCommunication, k);
    const double patience_ms = dictionary_->value(canopen::pdo_event_timer_ms(record));
    if (!rpdo.watched || patience_ms == 0.0 ||
        now_ns - rpdo.heard_ns <= static_cast<std::int64_t>(patience_ms) * kMs)
      continue;
    rpdo.watched = false;
    timed_out = true;
  }
  return timed_out;
}

// --- TPDOs ---------------------------------------------------------------------------------------

CanFrame CanopenPdos::pack(int k) noexcept {
  const auto cob_id = static_cast<std::uint32_t>(
      dictionary_->value(canopen::pdo_cob_id(record_of(canopen::kTpdoCommunication, k))));
  const std::uint16_t mapping = record_of(canopen::kTpdoMapping, k);
  const auto count = static_cast<int>(dictionary_->value(canopen::pdo_mapped_count(mapping)));
  FieldWriter fields(cob_id & ~kNoRtr, fd_);
  for (int i = 1; i <= count; ++i) {
    const DictionaryEntry* object = dictionary_->find(object_of(entry(mapping, i)));
    for (const std::uint8_t byte : object->bytes()) fields.put(byte, 1);
  }
  return fields.frame();
}

bool CanopenPdos::changed(int k, const CanFrame& frame) const noexcept {
  const Tpdo& tpdo = tpdos_[static_cast<std::size_t>(k)];
  return !tpdo.sent || frame.length != tpdo.frame.length || frame.data != tpdo.frame.data;
}

void CanopenPdos::sent(int k, const CanFrame& frame, std::int64_t now_ns) noexcept {
  Tpdo& tpdo = tpdos_[static_cast<std::size_t>(k)];
  tpdo.sent = true;
  tpdo.sent_ns = now_ns;
  tpdo.frame = frame;
}

bool CanopenPdos::due_at_sync(int k, CanFrame* frame) noexcept {
  const std::uint16_t record = record_of(canopen::kTpdoCommunication, k);
  const auto type = static_cast<int>(dictionary_->value(canopen::pdo_type(record)));
  if (!enabled(record) || type > canopen::kLastSynchronousType) return false;
  Tpdo& tpdo = tpdos_[static_cast<std::size_t>(k)];
  if (type > 0 && ++tpdo.syncs < type) return false;
  tpdo.syncs = 0;
  *frame = pack(k);
  if (type == 0 && !changed(k, *frame)) return false;
  sent(k, *frame, 0);
  return true;
}

bool CanopenPdos::awaits_event(int k) noexcept {
  const std::uint16_t record = record_of(canopen::kTpdoCommunication, k);
  return enabled(record) && dictionary_->value(canopen::pdo_type(record)) >= kOnEvent;
}

bool CanopenPdos::due_on_event(int k, std::int64_t now_ns, CanFrame* frame) noexcept {
  const std::uint16_t record = record_of(canopen::kTpdoCommunication, k);
  const Tpdo& tpdo = tpdos_[static_cast<std::size_t>(k)];
  const auto passed = static_cast<double>(now_ns - tpdo.sent_ns);
  const double inhibit = dictionary_->value(canopen::pdo_inhibit_time(record)) * kInhibitUnit_ns;
  if (tpdo.sent && passed < inhibit) return false;
  const double timer = dictionary_->value(canopen::pdo_event_timer_ms(record)) * kMs;
  *frame = pack(k);
  if (!changed(k, *frame) && !(timer > 0.0 && passed >= timer)) return false;
  sent(k, *frame, now_ns);
  return true;
}

void CanopenPdos::restart() noexcept {
  rpdos_.fill({});
  tpdos_.fill({});
}

}  // namespace limber::sim
