// No fuzz target: reads messages from standard input, each behind its length (four bytes,
// little-endian) and the number of its type (one byte, in that length), and writes what C++ makes
// of each in the same form, or the length FFFFFFFF for a refusal. For the comparison with Python.
#include <cstdio>

#include "tests/fuzz/support/message_types.h"

using namespace limber;

int main() {
  std::uint32_t size = 0;
  while (std::fread(&size, sizeof(size), 1, stdin) == 1) {
    std::vector<std::uint8_t> input(size);
    if (size == 0 || std::fread(input.data(), 1, size, stdin) != size) return 1;
    const auto again = fuzz::message_type_of(input[0]).encoded_again(std::span(input).subspan(1));
    const auto length = again ? static_cast<std::uint32_t>(again->size()) : 0xFFFFFFFFU;
    std::fwrite(&length, sizeof(length), 1, stdout);
    if (again) std::fwrite(again->data(), 1, again->size(), stdout);
  }
  return std::fflush(stdout) == 0 ? 0 : 1;
}
