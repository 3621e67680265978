// The series and the stages of one body for a level of the processor.

#define NAME(name) one_##name
#define element double
#if defined(__AVX__)
#include "algebra_one.h"
#else
#define of_element(name) name
#include "algebra_scalar.h"
#endif
#include "motion_series.h"
#include "one_motion.h"

static void set_one(const struct body_numbers *body, double *constants) { one_set(body, 0, (struct one_constants *)constants); }

static void expand_body(int order, const struct motion_kinds *which, const double *constants, double t, const double *state,
                           const double *table, const double *law, const double *given, const double *share,
                           const double *share_rest, double *c, int *exists) {
    const struct one_constants *const e = (const struct one_constants *)constants;
#define build_kind(...)                                                                                      \
    {                                                                                                        \
        const struct motion_kinds has = {__VA_ARGS__};                                                       \
        if (memcmp(&has, which, sizeof has) == 0) {                                                          \
            *exists = one_expand_with(&has, 1, order, e, t, state, table, law, given, share, share_rest, c); \
            return;                                                                                          \
        }                                                                                                    \
    }
#define build_kinds(...) build_kind(__VA_ARGS__) build_kind(.rotor = 1, __VA_ARGS__)
    for_single_effects(build_kinds);
#undef build_kinds
#undef build_kind
    *exists = one_expand_with(which, 0, order, e, t, state, table, law, given, share, share_rest, c);
}

#include "../one_body/body_stages.h"

#include "algebra_end.h"
