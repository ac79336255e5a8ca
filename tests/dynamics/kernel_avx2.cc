// The kernel for AVX2.
#define dynamics dynamics_avx2
#define LIMBER_EACH_PROCESSOR [[gnu::target("avx2")]]
#include "dynamics/arm_kernel.cc"
#include "tests/dynamics/kernel_terms.h"
#undef dynamics

namespace limber::test_kernel_bits {

std::vector<double> terms_by_avx2() { return dynamics_avx2::terms_of_random_chains(); }

}  // namespace limber::test_kernel_bits
