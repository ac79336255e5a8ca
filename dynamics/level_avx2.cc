#ifdef __x86_64__
#define LIMBER_LEVEL avx2
#define LIMBER_LANES 4
#define LIMBER_TARGET [[gnu::target("avx2")]]
#include "dynamics/row_level.h"
#endif
