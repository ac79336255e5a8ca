// The kernel for AVX-512.
#define dynamics dynamics_avx512
#define LIMBER_EACH_PROCESSOR [[gnu::target("avx512f")]]
#include "dynamics/arm_kernel.cc"
#include "tests/dynamics/kernel_terms.h"
#undef dynamics

namespace limber::test_kernel_bits {

std::vector<double> terms_by_avx512() { return dynamics_avx512::terms_of_random_chains(); }

}  // namespace limber::test_kernel_bits
