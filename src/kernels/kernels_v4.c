// The kernels for processors of the level x86-64-v4 (AVX-512).

#include "kernels.h"

#ifdef HAS_LEVELS
#pragma GCC target("arch=x86-64-v4")
#define KERNELS spintop_kernels_v4
#include "kernels_of_level.h"
#endif
