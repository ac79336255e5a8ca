// What must hold whatever the input: ends the process, as a sanitizer does, so that every fuzzer
// notices and keeps the input.
#pragma once

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>

namespace limber::fuzz {

inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "fuzz: violated: %s\n", what);
  std::abort();
}

inline void require_finite(std::initializer_list<double> numbers, const char* what) {
  for (const double number : numbers) require(std::isfinite(number), what);
}

}  // namespace limber::fuzz
