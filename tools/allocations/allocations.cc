#include "tools/allocations/allocations.h"

#include <cstddef>

// Also for what the program loads.
#pragma GCC visibility push(default)

#ifdef __has_feature  // clang's way to tell
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define LIMBER_SANITIZED_HEAP 1
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define LIMBER_SANITIZED_HEAP 1
#endif

#ifdef LIMBER_SANITIZED_HEAP
// From compiler-rt's sanitizer/allocator_interface.h, which GCC does not install.
extern "C" int __sanitizer_install_malloc_and_free_hooks(
    void (*malloc_hook)(const volatile void* pointer, std::size_t size),
    void (*free_hook)(const volatile void* pointer));
#endif

namespace {
thread_local std::int64_t count = 0;
}

#ifdef LIMBER_SANITIZED_HEAP
// The heap is the sanitizer's, which calls a hook at every allocation.
namespace {
void count_one(const volatile void*, std::size_t) { ++count; }
void ignore(const volatile void*) {}
[[maybe_unused]] const int kInstalled =
    __sanitizer_install_malloc_and_free_hooks(&count_one, &ignore);
}  // namespace
#else
// glibc's own entry points, under the names it exports for replacements of malloc. operator new
// ends in malloc.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* pointer, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  ++count;
  return __libc_malloc(size);
}
void* calloc(std::size_t number, std::size_t size) {
  ++count;
  return __libc_calloc(number, size);
}
void* realloc(void* pointer, std::size_t size) {
  ++count;
  return __libc_realloc(pointer, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  ++count;
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++count;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** pointer, std::size_t alignment, std::size_t size) {
  ++count;
  *pointer = __libc_memalign(alignment, size);
  return *pointer == nullptr ? 12 : 0;
}
}
#endif

std::int64_t limber_allocations() noexcept { return count; }
#pragma GCC visibility pop
