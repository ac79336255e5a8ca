#include "sim/nodes/canopen_dictionary.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace limber::sim {
namespace {

using canopen::SdoAbort;

constexpr double kMostCounts = 9e18;

int bytes_of(ValueType type) noexcept {
  switch (type) {
    case ValueType::kU8:
    case ValueType::kI8:
      return 1;
    case ValueType::kU16:
    case ValueType::kI16:
      return 2;
    default:
      return 4;
  }
}

bool is_signed(ValueType type) noexcept {
  return type == ValueType::kI8 || type == ValueType::kI16 || type == ValueType::kI32;
}

double from_raw(std::uint32_t raw, ValueType type) noexcept {
  if (type == ValueType::kFloat) return static_cast<double>(std::bit_cast<float>(raw));
  if (!is_signed(type)) return raw;
  const auto unused = static_cast<unsigned>(32 - 8 * bytes_of(type));
  return static_cast<std::int32_t>(raw << unused) >> unused;
}

std::uint32_t to_raw(double value, ValueType type) noexcept {
  if (type == ValueType::kFloat) return std::bit_cast<std::uint32_t>(static_cast<float>(value));
  if (!(std::abs(value) < kMostCounts)) return 0;
  return static_cast<std::uint32_t>(static_cast<std::int64_t>(value));
}

std::uint32_t raw_of(std::span<const std::uint8_t> bytes) noexcept {
  std::uint32_t raw = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i)
    raw |= static_cast<std::uint32_t>(bytes[i]) << (8 * i);
  return raw;
}

}  // namespace

double DictionaryEntry::value() const noexcept { return from_raw(raw_of(bytes()), type); }

void DictionaryEntry::set(double value) noexcept {
  std::uint32_t raw = to_raw(value, type);
  for (std::size_t i = 0; i < length; ++i, raw >>= 8U) data[i] = static_cast<std::uint8_t>(raw);
}

// --- set-up --------------------------------------------------------------------------------------

void CanopenDictionary::add(const canopen::Object& object, ValueType type, double value,
                            Access access, Mapping mapping) {
  DictionaryEntry entry;
  entry.id = object.id;
  entry.type = type;
  entry.access = access;
  entry.mapping = mapping;
  entry.length = static_cast<std::uint8_t>(bytes_of(type));
  entry.min = is_signed(type) ? -std::ldexp(1.0, 8 * entry.length - 1) : 0.0;
  entry.max = std::ldexp(1.0, 8 * entry.length - (is_signed(type) ? 1 : 0)) - 1.0;
  entry.set(value);
  entries_.push_back(entry);
}

void CanopenDictionary::add_writable(const canopen::Object& object, ValueType type, double value,
                                     double min, double max, Mapping mapping) {
  add(object, type, value, Access::kReadWrite, mapping);
  entries_.back().min = min;
  entries_.back().max = max;
}

void CanopenDictionary::add_text(canopen::ObjectId id, const std::string& text, Access access) {
  DictionaryEntry entry;
  entry.id = id;
  entry.type = ValueType::kText;
  entry.access = access;
  entry.length = static_cast<std::uint8_t>(std::min(text.size(), DictionaryEntry::kLongest));
  std::copy_n(text.begin(), entry.length, entry.data.begin());
  entries_.push_back(entry);
}

void CanopenDictionary::close(DictionaryGuard* guard) {
  guard_ = guard;
  std::ranges::sort(entries_, {}, [](const DictionaryEntry& entry) { return entry.id.number(); });
  power_on_ = entries_;
  numbers_.clear();
  for (const DictionaryEntry& entry : entries_) numbers_.push_back(entry.id.number());
}

// --- in the cycle --------------------------------------------------------------------------------

DictionaryEntry* CanopenDictionary::find(canopen::ObjectId id) noexcept {
  const auto found = std::ranges::lower_bound(numbers_, id.number());
  if (found == numbers_.end() || *found != id.number()) return nullptr;
  return &entries_[static_cast<std::size_t>(found - numbers_.begin())];
}

SdoAbort CanopenDictionary::absence(canopen::ObjectId id) const noexcept {
  const bool has_index = std::ranges::any_of(
      entries_, [&](const DictionaryEntry& entry) { return entry.id.index == id.index; });
  return has_index ? SdoAbort::kNoSuchSub : SdoAbort::kNoSuchObject;
}

Refusal CanopenDictionary::write(DictionaryEntry* entry,
                                 std::span<const std::uint8_t> bytes) noexcept {
  if (entry->access == Access::kReadOnly) return SdoAbort::kReadOnly;
  const bool text = entry->type == ValueType::kText;
  if (text ? bytes.size() > DictionaryEntry::kLongest : bytes.size() != entry->length)
    return SdoAbort::kLength;
  const double value = text ? 0.0 : from_raw(raw_of(bytes), entry->type);
  if (!text && std::isnan(value)) return SdoAbort::kValueRange;
  if (!text && value > entry->max) return SdoAbort::kTooHigh;
  if (!text && value < entry->min) return SdoAbort::kTooLow;
  if (const Refusal refusal = guard_->refuses(*entry, value)) return refusal;
  std::ranges::copy(bytes, entry->data.begin());
  entry->length = static_cast<std::uint8_t>(bytes.size());
  guard_->on_written(entry->id);
  return {};
}

void CanopenDictionary::reset(std::uint16_t first, std::uint16_t last) noexcept {
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (entries_[i].id.index >= first && entries_[i].id.index <= last) entries_[i] = power_on_[i];
  }
}

}  // namespace limber::sim
