#include "drivers/can/virtual_frame.h"

#include <algorithm>
#include <array>
#include <bit>
#include <optional>
#include <string_view>

namespace limber {
namespace {

// MessagePack type bytes.
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

class Writer {
 public:
  explicit Writer(std::span<std::uint8_t> out) : out_(out) {}
  void byte(std::uint8_t value) noexcept { out_[size_++] = value; }
  void big_endian(std::uint64_t value, unsigned bytes) noexcept {
    while (bytes-- > 0) byte(static_cast<std::uint8_t>(value >> (8 * bytes)));
  }
  /// In the shortest form, as Python's encoder does.
  void integer(std::uint32_t value) noexcept {
    const unsigned bytes = value < 0x100 ? 1 : value < 0x10000 ? 2 : 4;
    if (value >= kFixMap) byte(static_cast<std::uint8_t>(kUint8 + bytes / 2));
    big_endian(value, bytes);
  }
  void key(std::string_view name) noexcept {
    byte(static_cast<std::uint8_t>(kFixStr | name.size()));
    for (const char c : name) byte(static_cast<std::uint8_t>(c));
  }
  void boolean(std::string_view name, bool value) noexcept {
    key(name);
    byte(value ? kTrue : kFalse);
  }
  std::size_t size() const noexcept { return size_; }

 private:
  std::span<std::uint8_t> out_;
  std::size_t size_ = 0;
};

/// Reads forward; everything fails once the bytes have run out.
class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : left_(bytes) {}

  bool at_end() const noexcept { return left_.empty(); }
  std::optional<std::uint8_t> peek() const noexcept {
    return left_.empty() ? std::nullopt : std::optional(left_.front());
  }
  bool take(std::size_t count, std::span<const std::uint8_t>* bytes) noexcept {
    if (count > left_.size()) return false;
    *bytes = left_.first(count);
    left_ = left_.subspan(count);
    return true;
  }
  bool big_endian(unsigned count, std::uint64_t* value) noexcept {
    std::span<const std::uint8_t> bytes;
    if (!take(count, &bytes)) return false;
    *value = 0;
    for (const std::uint8_t byte : bytes) *value = *value << 8U | byte;
    return true;
  }
  bool type(std::uint8_t* value) noexcept {
    std::uint64_t wide = 0;
    if (!big_endian(1, &wide)) return false;
    *value = static_cast<std::uint8_t>(wide);
    return true;
  }
  bool map_size(std::uint64_t* pairs) noexcept {
    std::uint8_t t = 0;
    if (!type(&t)) return false;
    *pairs = t & 0x0FU;
    if ((t & 0xF0U) == kFixMap) return true;
    return (t == kMap16 || t == kMap32) && big_endian(t == kMap16 ? 2 : 4, pairs);
  }
  bool text(std::string_view* value) noexcept {
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
  bool boolean(bool* value) noexcept {
    std::uint8_t t = 0;
    if (!type(&t) || (t != kTrue && t != kFalse)) return false;
    *value = t == kTrue;
    return true;
  }
  /// A non-negative integer in any of the widths.
  bool integer(std::uint64_t* value) noexcept {
    std::uint8_t t = 0;
    if (!type(&t)) return false;
    *value = t;
    if (t < kFixMap) return true;
    if (t >= kUint8 && t <= kUint64) return big_endian(1U << (t - kUint8), value);
    if (t < kInt8 || t > kInt64) return false;
    const unsigned bytes = 1U << (t - kInt8);
    return big_endian(bytes, value) && (*value >> (8 * bytes - 1)) == 0;
  }
  bool binary(std::span<const std::uint8_t>* value) noexcept {
    std::uint8_t t = 0;
    std::uint64_t length = 0;
    if (!type(&t) || t < kBin8 || t > kBin32) return false;
    return big_endian(1U << (t - kBin8), &length) && take(length, value);
  }
  bool nil() noexcept {
    if (peek() != kNil) return false;
    left_ = left_.subspan(1);
    return true;
  }
  /// Any value, with all that it contains. Each pending object needs at least one byte, so this
  /// ends.
  bool skip() noexcept {
    for (std::uint64_t pending = 1; pending > 0; --pending) {
      std::uint64_t inside = 0;
      if (pending > left_.size() || !skip_head(&inside)) return false;
      pending += inside;
    }
    return true;
  }

 private:
  /// Takes one object without the `inside` objects that it contains.
  bool skip_head(std::uint64_t* inside) noexcept {
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
  bool skip_short(std::uint8_t t, std::uint64_t* inside) noexcept {
    if (t >= kFixStr) return drop(t & 0x1FU);
    *inside = (t & 0x0FU) * (t < kFixArray ? std::uint64_t{2} : 1);
    return true;
  }
  bool drop(std::uint64_t count) noexcept {
    std::span<const std::uint8_t> ignored;
    return take(count, &ignored);
  }

  std::span<const std::uint8_t> left_;
};

struct Fields {
  std::optional<std::uint64_t> id;
  std::optional<std::uint64_t> dlc;
  std::span<const std::uint8_t> data;
  bool extended = true;
  bool remote = false;
  bool error = false;
  bool fd = false;
  bool bitrate_switch = false;
};

bool read_optional_integer(Reader* reader, std::optional<std::uint64_t>* value) noexcept {
  std::uint64_t number = 0;
  if (!reader->integer(&number)) return false;
  *value = number;
  return true;
}

bool read_value(std::string_view key, Reader* reader, Fields* fields) noexcept {
  if (key == "arbitration_id") return read_optional_integer(reader, &fields->id);
  if (key == "dlc") return reader->nil() || read_optional_integer(reader, &fields->dlc);
  if (key == "data") return reader->nil() || reader->binary(&fields->data);
  if (key == "is_extended_id") return reader->boolean(&fields->extended);
  if (key == "is_remote_frame") return reader->boolean(&fields->remote);
  if (key == "is_error_frame") return reader->boolean(&fields->error);
  if (key == "is_fd") return reader->boolean(&fields->fd);
  if (key == "bitrate_switch") return reader->boolean(&fields->bitrate_switch);
  return reader->skip();
}

bool to_frame(const Fields& fields, CanFrame* frame) noexcept {
  const std::uint64_t length = fields.dlc.value_or(fields.data.size());
  if (!fields.id || *fields.id > kExtendedIdMax || length > frame->data.size()) return false;
  if (!fields.extended && *fields.id > kStandardIdMax) return false;
  if (!fields.remote && length != fields.data.size()) return false;
  *frame = CanFrame{};
  frame->id = static_cast<std::uint32_t>(*fields.id);
  frame->extended = fields.extended;
  frame->remote = fields.remote;
  frame->error = fields.error;
  frame->fd = fields.fd;
  frame->bitrate_switch = fields.bitrate_switch;
  frame->length = static_cast<std::uint8_t>(length);
  if (!fields.remote) std::copy(fields.data.begin(), fields.data.end(), frame->data.begin());
  return is_possible(*frame);
}

}  // namespace

std::size_t encode_datagram(const CanFrame& frame, std::span<std::uint8_t> out) noexcept {
  constexpr std::uint8_t kKeys = 11;
  const std::uint8_t data_bytes = frame.remote ? 0 : frame.length;
  Writer w(out);
  w.byte(kFixMap | kKeys);
  w.key("timestamp");
  w.byte(kFloat64);
  w.big_endian(std::bit_cast<std::uint64_t>(static_cast<double>(frame.timestamp_ns) * 1e-9), 8);
  w.key("arbitration_id");
  w.integer(frame.id);
  // An error frame's id holds class bits, which may need more than 11 bits.
  w.boolean("is_extended_id", frame.extended || frame.id > kStandardIdMax);
  w.boolean("is_remote_frame", frame.remote);
  w.boolean("is_error_frame", frame.error);
  w.key("channel");
  w.byte(kNil);
  w.key("dlc");
  w.integer(frame.length);
  w.key("data");
  w.byte(kBin8);
  w.byte(data_bytes);
  for (std::size_t i = 0; i < data_bytes; ++i) w.byte(frame.data[i]);
  w.boolean("is_fd", frame.fd);
  w.boolean("bitrate_switch", frame.bitrate_switch);
  w.boolean("error_state_indicator", false);
  return w.size();
}

bool decode_datagram(std::span<const std::uint8_t> datagram, CanFrame* frame) noexcept {
  Reader reader(datagram);
  std::uint64_t pairs = 0;
  if (!reader.map_size(&pairs)) return false;
  Fields fields;
  for (; pairs > 0; --pairs) {
    std::string_view key;
    if (!reader.text(&key) || !read_value(key, &reader, &fields)) return false;
  }
  return reader.at_end() && to_frame(fields, frame);
}

}  // namespace limber
