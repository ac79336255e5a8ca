// The kernel for AVX-512.
#define dynamics dynamics_avx512
#define LIMBER_EACH_PROCESSOR [[gnu::target("avx512f")]]
#include "dynamics/arm_kernel.cc"
#include "dynamics/geometric_mean.cc"
#include "dynamics/spd_solve.cc"
#include "tests/dynamics/kernel_terms.h"
