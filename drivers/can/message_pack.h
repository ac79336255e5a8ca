// As much of MessagePack as a CAN frame needs: written in Python's shortest forms, read in any
// form. No allocation, no recursion. Format: https://github.com/msgpack/msgpack/blob/master/spec.md
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace limber::message_pack {

/// Writes into a buffer that is known to be long enough.
class Writer {
 public:
  explicit Writer(std::span<std::uint8_t> out) : out_(out) {}

  void map(std::uint8_t pairs) noexcept;       ///< at most 15 pairs; they follow
  void text(std::string_view value) noexcept;  ///< at most 31 bytes
  void integer(std::uint32_t value) noexcept;
  void real(double value) noexcept;
  void boolean(bool value) noexcept;
  void nil() noexcept;
  void binary(std::span<const std::uint8_t> bytes) noexcept;  ///< at most 255 bytes

  std::size_t size() const noexcept { return size_; }

 private:
  void byte(std::uint8_t value) noexcept { out_[size_++] = value; }
  void big_endian(std::uint64_t value, unsigned bytes) noexcept;

  std::span<std::uint8_t> out_;
  std::size_t size_ = 0;
};

/// Reads forward through bytes of unknown origin. A member returns false if the next object is of
/// another kind or the bytes have run out; the reader is then of no further use, unless the member
/// says otherwise.
class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : left_(bytes) {}

  bool map(std::uint64_t* pairs) noexcept;
  bool text(std::string_view* value) noexcept;
  bool integer(std::uint64_t* value) noexcept;  ///< not negative, in any width
  bool boolean(bool* value) noexcept;
  bool binary(std::span<const std::uint8_t>* value) noexcept;
  bool nil() noexcept;                ///< false leaves the reader where it was
  bool real(double* value) noexcept;  ///< 64 bits; false leaves the reader where it was
  bool skip() noexcept;               ///< any object, with all that it contains

  bool at_end() const noexcept { return left_.empty(); }

 private:
  bool type(std::uint8_t* value) noexcept;
  bool big_endian(unsigned bytes, std::uint64_t* value) noexcept;
  bool take(std::uint64_t count, std::span<const std::uint8_t>* bytes) noexcept;
  bool drop(std::uint64_t count) noexcept;
  bool skip_head(std::uint64_t* inside) noexcept;
  bool skip_short(std::uint8_t type, std::uint64_t* inside) noexcept;

  std::span<const std::uint8_t> left_;
};

}  // namespace limber::message_pack
