// The series of one body with effects for a level of the processor.

#include "algebra_one.h"
#include "motion_series.h"
#include "one_motion.h"

static void set_one(const struct body_numbers *body, double *constants) { one_set(body, 0, (struct one_constants *)constants); }

// A single effect has a build of its own, in which nothing is asked in loops.
static void expand_effects(int order, const struct motion_kinds *which, const double *constants, double t, const double *state,
                           const double *table, const double *law, const double *given, const double *share,
                           const double *share_rest, double *c, int *exists) {
    const struct one_constants *const e = (const struct one_constants *)constants;
#define try_kind(...)                                                                                        \
    do {                                                                                                     \
        const struct motion_kinds has = {__VA_ARGS__};                                                       \
        if (memcmp(&has, which, sizeof has) == 0) {                                                          \
            *exists = one_expand_with(&has, 1, order, e, t, state, table, law, given, share, share_rest, c); \
            return;                                                                                          \
        }                                                                                                    \
    } while (0)
#define try_kinds(...)     \
    try_kind(__VA_ARGS__); \
    try_kind(.rotor = 1, __VA_ARGS__)
    try_kinds(.drags = 0);
    try_kinds(.frame = along);
    try_kinds(.frame = anyhow);
    try_kinds(.torque = along);
    try_kinds(.torque = anyhow);
    try_kinds(.push = along);
    try_kinds(.push = anyhow);
    try_kinds(.drags = of_moment + 1);
    try_kinds(.drags = of_force + 1);
#undef try_kinds
#undef try_kind
    *exists = one_expand_with(which, 0, order, e, t, state, table, law, given, share, share_rest, c);
}

#include "algebra_end.h"
