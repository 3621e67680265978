// The floating-point environment of the calling thread: rounding, traps, and what processors flush to zero.

#include <fenv.h>

_Static_assert(sizeof(fenv_t) <= 64, "arithmetic.f90 has no room for the environment");

// Keeps the environment of the caller, and takes the default one: rounding to nearest, no traps, nothing flushed.
void spintop_hold_arithmetic(fenv_t *held) {
    fegetenv(held);
    fesetenv(FE_DFL_ENV);
}

// Takes the environment of the caller again; what was signalled meanwhile is forgotten.
void spintop_restore_arithmetic(const fenv_t *held) { fesetenv(held); }
