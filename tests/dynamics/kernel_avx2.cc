// The kernel for AVX2.
#define dynamics dynamics_avx2
#define LIMBER_EACH_PROCESSOR [[gnu::target("avx2")]]
#include "dynamics/arm_kernel.cc"
#include "dynamics/geometric_mean.cc"
#include "dynamics/spd_solve.cc"
#include "tests/dynamics/kernel_terms.h"
