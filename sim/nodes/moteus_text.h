// The text of an emulated moteus drive's diagnostic channel: lines in, answers out.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace limber::sim {

/// Allowed in the cycle throughout. What finds no room is lost, as in the drive.
class MoteusText {
 public:
  /// Text from the client.
  void take(std::string_view text) noexcept;
  /// The next whole line, without its end; it lives until the next take().
  bool line(std::string_view* line) noexcept;

  void write(std::string_view text) noexcept;
  /// "NAME VALUE", with six decimals or none.
  void write_value(std::string_view before, double value, bool whole,
                   std::string_view after) noexcept;
  void ok() noexcept { write("OK\r\n"); }
  void error(std::string_view why) noexcept;

  /// What has been written and not read yet, at most so many bytes.
  std::string_view read(std::size_t most) noexcept;

 private:
  std::array<char, 128> in_{};
  std::size_t in_size_ = 0;
  std::size_t line_size_ = 0;  ///< given away by line(), with its end
  std::array<char, 4096> out_{};
  std::size_t read_ = 0;
  std::size_t written_ = 0;
};

/// Cuts the first word off; both without spaces around.
std::string_view next_word(std::string_view* text) noexcept;
/// False unless the whole word is a number; "nan" is one.
bool parse_number(std::string_view word, double* value) noexcept;

}  // namespace limber::sim
