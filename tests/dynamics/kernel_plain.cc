// The kernel for what every processor has.
#define dynamics dynamics_plain
#define LIMBER_EACH_PROCESSOR
#include "dynamics/arm_kernel.cc"
#include "dynamics/geometric_mean.cc"
#include "dynamics/spd_solve.cc"
#include "tests/dynamics/kernel_terms.h"
