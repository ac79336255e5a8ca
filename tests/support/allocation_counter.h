// Counts heap allocations, so that a test can prove that a cycle makes none. Link
// limber_allocation_counter.
#pragma once

#include <cstdint>

namespace limber::testing {

/// Allocations (operator new, malloc, calloc, realloc, aligned forms) made by the calling thread so
/// far.
std::int64_t allocations() noexcept;

}  // namespace limber::testing
