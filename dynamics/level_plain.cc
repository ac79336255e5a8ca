// What every processor has: SSE2, or NEON.
#include "dynamics/row_level.h"
