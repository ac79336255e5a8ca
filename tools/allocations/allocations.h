// Counts heap allocations, to prove that a cycle makes none. Link limber_allocation_counter.
#pragma once

#include <cstdint>

extern "C" __attribute__((visibility("default"))) std::int64_t limber_allocations() noexcept;

namespace limber {

/// Allocations (operator new, malloc, calloc, realloc, aligned forms) made by the calling thread so
/// far.
inline std::int64_t allocations() noexcept { return limber_allocations(); }

}  // namespace limber
