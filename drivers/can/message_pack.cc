#include "drivers/can/message_pack.h"

#include <array>
#include <bit>

namespace limber::message_pack {
namespace {

// Type bytes.
constexpr std::uint8_t kFixMap = 0x80;
constexpr std::uint8_t kFixArray = 0x90;
constexpr std::uint8_t kFixStr = 0xA0;
constexpr std::uint8_t kNil = 0xC0;
constexpr std::uint8_t kFalse = 0xC2;
constexpr std::uint8_t kTrue = 0xC3;
constexpr std::uint8_t kBin8 = 0xC4;
constexpr std::uint8_t kBin32 = 0xC6;
constexpr std::uint8_t kFloat64 = 0xCB;
constexpr std::uint8_t kUint8 = 0xCC;
constexpr std::uint8_t kUint64 = 0xCF;
constexpr std::uint8_t kInt8 = 0xD0;
constexpr std::uint8_t kInt64 = 0xD3;
constexpr std::uint8_t kStr8 = 0xD9;
constexpr std::uint8_t kStr32 = 0xDB;
constexpr std::uint8_t kMap16 = 0xDE;
constexpr std::uint8_t kMap32 = 0xDF;

/// What follows a type byte: a big-endian count of `count_bytes`, `fixed_bytes`, and per count so
/// many bytes or objects.
struct Shape {
  std::uint8_t count_bytes;
  std::uint8_t fixed_bytes;
  std::uint8_t bytes_per_count;
  std::uint8_t objects_per_count;
};
constexpr Shape fixed(std::uint8_t bytes) { return {0, bytes, 0, 0}; }
constexpr Shape text_or_bin(std::uint8_t count_bytes) { return {count_bytes, 0, 1, 0}; }
constexpr Shape ext(std::uint8_t count_bytes) { return {count_bytes, 1, 1, 0}; }
constexpr Shape array(std::uint8_t count_bytes) { return {count_bytes, 0, 0, 1}; }
constexpr Shape map(std::uint8_t count_bytes) { return {count_bytes, 0, 0, 2}; }

constexpr std::uint8_t kFirstLongType = 0xC0;
constexpr std::uint8_t kUnusedType = 0xC1;
constexpr std::array<Shape, 32> kLongTypes = {{
    fixed(0),       fixed(0),       fixed(0),       fixed(0),  // nil, unused, false, true
    text_or_bin(1), text_or_bin(2), text_or_bin(4),            // bin
    ext(1),         ext(2),         ext(4),                    //
    fixed(4),       fixed(8),                                  // float
    fixed(1),       fixed(2),       fixed(4),       fixed(8),  // unsigned
    fixed(1),       fixed(2),       fixed(4),       fixed(8),  // signed
    fixed(2),       fixed(3),       fixed(5),       fixed(9),
    fixed(17),                                               // ext of 1, 2, 4, 8, 16 bytes
    text_or_bin(1), text_or_bin(2), text_or_bin(4),          // str
    array(2),       array(4),       map(2),         map(4),  //
}};

}  // namespace

void Writer::big_endian(std::uint64_t value, unsigned bytes) noexcept {
  while (bytes-- > 0) byte(static_cast<std::uint8_t>(value >> (8 * bytes)));
}

void Writer::map(std::uint8_t pairs) noexcept { byte(kFixMap | pairs); }

void Writer::text(std::string_view value) noexcept {
  byte(static_cast<std::uint8_t>(kFixStr | value.size()));
  for (const char c : value) byte(static_cast<std::uint8_t>(c));
}

void Writer::integer(std::uint32_t value) noexcept {
  const unsigned bytes = value < 0x100 ? 1 : value < 0x10000 ? 2 : 4;
  if (value >= kFixMap) byte(static_cast<std::uint8_t>(kUint8 + bytes / 2));
  big_endian(value, bytes);
}

void Writer::real(double value) noexcept {
  byte(kFloat64);
  big_endian(std::bit_cast<std::uint64_t>(value), 8);
}

void Writer::boolean(bool value) noexcept { byte(value ? kTrue : kFalse); }
void Writer::nil() noexcept { byte(kNil); }

void Writer::binary(std::span<const std::uint8_t> bytes) noexcept {
  byte(kBin8);
  byte(static_cast<std::uint8_t>(bytes.size()));
  for (const std::uint8_t value : bytes) byte(value);
}

bool Reader::take(std::uint64_t count, std::span<const std::uint8_t>* bytes) noexcept {
  if (count > left_.size()) return false;
  *bytes = left_.first(count);
  left_ = left_.subspan(count);
  return true;
}

bool Reader::drop(std::uint64_t count) noexcept {
  std::span<const std::uint8_t> ignored;
  return take(count, &ignored);
}

bool Reader::big_endian(unsigned bytes, std::uint64_t* value) noexcept {
  std::span<const std::uint8_t> taken;
  if (!take(bytes, &taken)) return false;
  *value = 0;
  for (const std::uint8_t byte : taken) *value = *value << 8U | byte;
  return true;
}

bool Reader::type(std::uint8_t* value) noexcept {
  std::span<const std::uint8_t> taken;
  if (!take(1, &taken)) return false;
  *value = taken.front();
  return true;
}

bool Reader::map(std::uint64_t* pairs) noexcept {
  std::uint8_t t = 0;
  if (!type(&t)) return false;
  *pairs = t & 0x0FU;
  if ((t & 0xF0U) == kFixMap) return true;
  return (t == kMap16 || t == kMap32) && big_endian(t == kMap16 ? 2 : 4, pairs);
}

bool Reader::text(std::string_view* value) noexcept {
  std::uint8_t t = 0;
  if (!type(&t)) return false;
  std::uint64_t length = t & 0x1FU;
  if ((t & 0xE0U) != kFixStr) {
    if (t < kStr8 || t > kStr32 || !big_endian(1U << (t - kStr8), &length)) return false;
  }
  std::span<const std::uint8_t> bytes;
  if (!take(length, &bytes)) return false;
  *value = {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  return true;
}

bool Reader::boolean(bool* value) noexcept {
  std::uint8_t t = 0;
  if (!type(&t) || (t != kTrue && t != kFalse)) return false;
  *value = t == kTrue;
  return true;
}

bool Reader::integer(std::uint64_t* value) noexcept {
  std::uint8_t t = 0;
  if (!type(&t)) return false;
  *value = t;
  if (t < kFixMap) return true;
  if (t >= kUint8 && t <= kUint64) return big_endian(1U << (t - kUint8), value);
  if (t < kInt8 || t > kInt64) return false;
  const unsigned bytes = 1U << (t - kInt8);
  return big_endian(bytes, value) && (*value >> (8 * bytes - 1)) == 0;
}

bool Reader::binary(std::span<const std::uint8_t>* value) noexcept {
  std::uint8_t t = 0;
  std::uint64_t length = 0;
  if (!type(&t) || t < kBin8 || t > kBin32) return false;
  return big_endian(1U << (t - kBin8), &length) && take(length, value);
}

bool Reader::nil() noexcept {
  if (left_.empty() || left_.front() != kNil) return false;
  left_ = left_.subspan(1);
  return true;
}

bool Reader::real(double* value) noexcept {
  std::uint64_t bits = 0;
  if (left_.size() < 9 || left_.front() != kFloat64) return false;
  left_ = left_.subspan(1);
  big_endian(8, &bits);
  *value = std::bit_cast<double>(bits);
  return true;
}

// Each object takes at least one byte, so this ends, however many objects a header promises.
bool Reader::skip() noexcept {
  for (std::uint64_t pending = 1; pending > 0; --pending) {
    std::uint64_t inside = 0;
    if (!skip_head(&inside)) return false;
    pending += inside;
  }
  return true;
}

/// Takes one object without the `inside` objects that it contains.
bool Reader::skip_head(std::uint64_t* inside) noexcept {
  std::uint8_t t = 0;
  if (!type(&t) || t == kUnusedType) return false;
  if (t < kFixMap || t > kMap32) return true;  // small integers
  if (t < kFirstLongType) return skip_short(t, inside);
  const Shape shape = kLongTypes[t - kFirstLongType];
  std::uint64_t count = 0;
  if (shape.count_bytes > 0 && !big_endian(shape.count_bytes, &count)) return false;
  *inside = count * shape.objects_per_count;
  return drop(shape.fixed_bytes + count * shape.bytes_per_count);
}

bool Reader::skip_short(std::uint8_t t, std::uint64_t* inside) noexcept {
  if (t >= kFixStr) return drop(t & 0x1FU);
  *inside = (t & 0x0FU) * (t < kFixArray ? std::uint64_t{2} : 1);
  return true;
}

}  // namespace limber::message_pack
