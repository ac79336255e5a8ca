#include "tests/fuzz/support/mutate.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <string_view>

namespace limber::fuzz {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kNumbers[] = {kNan, std::numeric_limits<double>::infinity(), -1e308, 5e-324, -0.0};
constexpr float kNarrow[] = {static_cast<float>(kNan), std::numeric_limits<float>::infinity(),
                             -3e38F, 1e-45F};
constexpr std::string_view kTexts[] = {"nan",  "-1",  "1e999", "0",  "\"",   "<",    ">",  "&lt;",
                                       "&",    "{",   "}",     "[",  "]",    ":",    ",",  "\n",
                                       "\t",   "- ",  "&a ",   "*a", "!!x",  "null", "%",  "'",
                                       "\xff", "---", "| ",    "? ", "<<: ", "#",    "()", " "};

class Mutator {
 public:
  Mutator(Bytes* bytes, const Bytes& other, std::mt19937_64& random)
      : bytes_(*bytes), other_(other), random_(random) {}

  void change() {
    if (bytes_.empty()) bytes_.push_back(0);
    switch (below(9)) {
      case 0:
        bytes_[at()] ^= static_cast<std::uint8_t>(1U << below(8));
        break;
      case 1:
        bytes_[at()] = static_cast<std::uint8_t>(random_());
        break;
      case 2:
        overwrite_number();
        break;
      case 3:
        erase();
        break;
      case 4:
        insert(bytes_);
        break;
      case 5:
        insert(other_);
        break;
      case 6:
        insert_text();
        break;
      case 7:
        bytes_[at()] += below(2) == 0 ? 1 : 255;
        break;
      default:
        overwrite(bytes_);
    }
    if (bytes_.size() > kMostBytes) bytes_.resize(kMostBytes);
  }

 private:
  std::size_t below(std::size_t end) { return static_cast<std::size_t>(random_() % end); }
  std::size_t at() { return below(bytes_.size()); }

  Bytes piece_of(const Bytes& from) {
    if (from.empty()) return {};
    const std::size_t start = below(from.size());
    const std::size_t length = std::min(from.size() - start, 1 + below(40));
    const auto first = from.begin() + static_cast<std::ptrdiff_t>(start);
    return {first, first + static_cast<std::ptrdiff_t>(length)};
  }
  void erase() {
    const std::size_t start = at();
    const std::size_t length = std::min(bytes_.size() - start, 1 + below(30));
    const auto first = bytes_.begin() + static_cast<std::ptrdiff_t>(start);
    bytes_.erase(first, first + static_cast<std::ptrdiff_t>(length));
  }
  void insert(const Bytes& from) {
    const Bytes piece = piece_of(from);
    bytes_.insert(bytes_.begin() + static_cast<std::ptrdiff_t>(at()), piece.begin(), piece.end());
  }
  void insert_text() {
    const std::string_view text = kTexts[below(std::size(kTexts))];
    bytes_.insert(bytes_.begin() + static_cast<std::ptrdiff_t>(at()), text.begin(), text.end());
  }
  void overwrite(const Bytes& from) {
    const Bytes piece = piece_of(from);
    write(piece.data(), piece.size());
  }
  void write(const void* data, std::size_t size) {
    const std::size_t start = at();
    std::memcpy(&bytes_[start], data, std::min(size, bytes_.size() - start));
  }
  template <typename Number>
  void write_either_way(Number value) {
    std::uint8_t raw[sizeof(Number)];
    std::memcpy(raw, &value, sizeof(raw));
    if (below(2) == 0) std::reverse(std::begin(raw), std::end(raw));
    write(raw, sizeof(raw));
  }
  void overwrite_number() {
    switch (below(4)) {
      case 0:
        return write_either_way(kNumbers[below(std::size(kNumbers))]);
      case 1:
        return write_either_way(kNarrow[below(std::size(kNarrow))]);
      case 2:
        return write_either_way(std::numeric_limits<std::int64_t>::max() >> below(64));
      default:
        return write_either_way(std::uint32_t{1} << below(32));
    }
  }

  Bytes& bytes_;
  const Bytes other_;  // a copy: it may be the input itself
  std::mt19937_64& random_;
};

}  // namespace

Bytes mutate(Bytes input, const Bytes& other, std::mt19937_64& random) {
  Mutator mutator(&input, other, random);
  for (std::uint64_t changes = 1 + random() % 8; changes > 0; --changes) mutator.change();
  return input;
}

}  // namespace limber::fuzz
