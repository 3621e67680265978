// The kernels for processors of the level x86-64-v3 (AVX2, FMA).

#include "kernels.h"

#ifdef HAS_LEVELS
#pragma GCC target("arch=x86-64-v3")
#define KERNELS spintop_kernels_v3
#include "kernels_of_level.h"
#endif
