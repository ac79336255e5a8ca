// A counter that counts nothing would let every test of "no allocation" pass. Under sanitizers the
// heap is theirs.
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <thread>

#include "tools/allocations/allocations.h"

namespace limber::test_allocation_counter {
namespace {

/// Keeps the compiler from leaving out an allocation that nobody uses.
void use(const volatile void* pointer) { asm volatile("" : : "r"(pointer) : "memory"); }

template <typename Call>
std::int64_t allocations_of(Call call) {
  const std::int64_t before = allocations();
  call();
  return allocations() - before;
}

TEST(AllocationCounter, CountsEveryWayToTheHeap) {
  EXPECT_EQ(allocations_of([] { use(std::make_unique<int>(1).get()); }), 1);
  EXPECT_EQ(allocations_of([] { use(std::make_unique<int[]>(100).get()); }), 1);
  struct alignas(64) Wide {
    char bytes[64];
  };
  EXPECT_EQ(allocations_of([] { use(std::make_unique<Wide>().get()); }), 1);
  const auto raw = [](void* pointer) {
    use(pointer);
    std::free(pointer);
  };
  EXPECT_EQ(allocations_of([&] { raw(std::malloc(10)); }), 1);
  EXPECT_EQ(allocations_of([&] { raw(std::calloc(10, 10)); }), 1);
  EXPECT_EQ(allocations_of([&] { raw(std::aligned_alloc(64, 128)); }), 1);
}

TEST(AllocationCounter, CountsNothingElseAndNoOtherThread) {
  EXPECT_EQ(allocations_of([] {
              int on_the_stack = 1;
              use(&on_the_stack);
            }),
            0);
  std::int64_t inside = 0;
  std::thread other([&] { inside = allocations_of([] { use(std::make_unique<int>(1).get()); }); });
  const std::int64_t outside = allocations_of([&] { other.join(); });
  EXPECT_EQ(inside, 1);
  EXPECT_EQ(outside, 0);
}

}  // namespace
}  // namespace limber::test_allocation_counter
