// The kernels for processors of the level x86-64-v2 (SSE4.2).

#include "kernels.h"

#ifdef HAS_LEVELS
#pragma GCC target("arch=x86-64-v2")
#define KERNELS spintop_kernels_v2
#include "kernels_of_level.h"
#endif
