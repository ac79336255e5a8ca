#ifdef __x86_64__
#define LIMBER_LEVEL avx512
#define LIMBER_LANES 8
#define LIMBER_TARGET [[gnu::target("avx512f")]]
#include "dynamics/row_level.h"
#endif
