// The kernel for what every processor has.
#define dynamics dynamics_plain
#define LIMBER_EACH_PROCESSOR
#include "dynamics/arm_kernel.cc"
#include "tests/dynamics/kernel_terms.h"
#undef dynamics

namespace limber::test_kernel_bits {

std::vector<double> terms_by_plain() { return dynamics_plain::terms_of_random_chains(); }

}  // namespace limber::test_kernel_bits
