// Whatever the width of the processor's registers, the kernel gives the same bits.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <vector>

// The same source for each kind of processor: kernel_plain.cc, kernel_avx2.cc, kernel_avx512.cc.
namespace limber::dynamics_plain {
std::vector<double> terms_of_random_chains();
}
namespace limber::dynamics_avx2 {
std::vector<double> terms_of_random_chains();
}
namespace limber::dynamics_avx512 {
std::vector<double> terms_of_random_chains();
}

namespace limber::test_kernel_bits {
namespace {

void expect_same_bits(const std::vector<double>& found) {
  const std::vector<double> plain = dynamics_plain::terms_of_random_chains();
  ASSERT_EQ(found.size(), plain.size());
  ASSERT_GT(plain.size(), 100'000U);
  for (std::size_t i = 0; i < plain.size(); ++i) {
    ASSERT_TRUE(std::isfinite(plain[i])) << i;
    ASSERT_EQ(std::bit_cast<std::uint64_t>(found[i]), std::bit_cast<std::uint64_t>(plain[i])) << i;
  }
}

TEST(KernelBits, OfAvx2) {
  if (!__builtin_cpu_supports("avx2")) GTEST_SKIP() << "this processor has no AVX2";
  expect_same_bits(dynamics_avx2::terms_of_random_chains());
}

TEST(KernelBits, OfAvx512) {
  if (!__builtin_cpu_supports("avx512f")) GTEST_SKIP() << "this processor has no AVX-512";
  expect_same_bits(dynamics_avx512::terms_of_random_chains());
}

}  // namespace
}  // namespace limber::test_kernel_bits
