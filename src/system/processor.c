// The level of the processor, by which kernels choose one of their builds when the program starts, and the arithmetic of the
// calling thread: rounding, traps, and what processors flush to zero. The levels of x86-64 are those of its psABI: v2
// (SSE4.2), v3 (AVX2, FMA) and v4 (AVX-512).

#include <fenv.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(sizeof(fenv_t) <= 64, "caller.f90 has no room for the environment");

int spintop_highest_level(void);
int spintop_processor_level(void);

// The highest level that processor and compiler have: 2, 3 or 4; 0 for the flags of the build.
int spintop_highest_level(void) {
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
    __builtin_cpu_init();
    if (__builtin_cpu_supports("x86-64-v4")) return 4;
    if (__builtin_cpu_supports("x86-64-v3")) return 3;
    return 2;
#else
    return 0;
#endif
}

// The level to use: the highest, or a lower one that SPINTOP_LEVEL names (v2, v3, v4).
int spintop_processor_level(void) {
    const int highest = spintop_highest_level();
    const char *const wanted = getenv("SPINTOP_LEVEL");
    for (int level = 2; wanted && level < highest; ++level) {
        const char name[] = {'v', (char)('0' + level), 0};
        if (strcmp(wanted, name) == 0) return level;
    }
    return highest;
}

// Keeps the environment of the caller, and takes the default one: rounding to nearest, no traps, nothing flushed.
void spintop_hold_arithmetic(fenv_t *held) {
    fegetenv(held);
    fesetenv(FE_DFL_ENV);
}

// Takes the environment of the caller again; what was signalled meanwhile is forgotten.
void spintop_restore_arithmetic(const fenv_t *held) { fesetenv(held); }
