// Whatever the width of the processor's registers, the kernel gives the same bits.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <vector>

namespace limber::test_kernel_bits {

// The same source for each kind of processor: kernel_plain.cc, kernel_avx2.cc, kernel_avx512.cc.
std::vector<double> terms_by_plain();
std::vector<double> terms_by_avx2();
std::vector<double> terms_by_avx512();

namespace {

void expect_same_bits(const std::vector<double>& found) {
  const std::vector<double> plain = terms_by_plain();
  ASSERT_EQ(found.size(), plain.size());
  ASSERT_GT(plain.size(), 100'000U);
  for (std::size_t i = 0; i < plain.size(); ++i) {
    ASSERT_TRUE(std::isfinite(plain[i])) << i;
    ASSERT_EQ(std::bit_cast<std::uint64_t>(found[i]), std::bit_cast<std::uint64_t>(plain[i])) << i;
  }
}

TEST(KernelBits, OfAvx2) {
  if (!__builtin_cpu_supports("avx2")) GTEST_SKIP() << "this processor has no AVX2";
  expect_same_bits(terms_by_avx2());
}

TEST(KernelBits, OfAvx512) {
  if (!__builtin_cpu_supports("avx512f")) GTEST_SKIP() << "this processor has no AVX-512";
  expect_same_bits(terms_by_avx512());
}

}  // namespace
}  // namespace limber::test_kernel_bits
