// The series and the stages of one body, and the series of bodies in lanes with effects, for a level of the processor.

#define NAME(name) one_##name
#define element double
#if defined(__AVX__)
#include "algebra_one.h"
#else
#define of_element(name) name
#include "algebra_scalar.h"
#endif
#include "motion_series.h"

static void expand_body(int order, const struct motion_kinds *which, const double *constants, double t, const double *state,
                        const double *table, const double *law, const double *given, double *c, int *exists) {
    const struct one_constants *const e = (const struct one_constants *)constants;
#define expand_as(has, joins) *exists = one_expand_with(has, joins, order, e, t, state, table, law, given, c)
    for_single_effects(build_kinds);
    expand_as(which, 0);
#undef expand_as
}

#include "../one_body/body_stages.h"

#include "algebra_end.h"

#include "algebra_lanes.h"
#include "motion_series.h"

_Static_assert((int)lanes_rows == (int)rows && (int)lanes_more == (int)more_rows, "the rows are those of kernels.h");

inlined void lanes_expand_with(const struct motion_kinds *has, int joins, int order, const struct lanes_constants *e,
                               const double *t, const double *side, const double *state, double *c, double *x) {
    struct lanes_start of;
    const vector none = {0};
    for (int lane = 0; lane < lanes; lane += width) {
        for (int row = w1; row <= angle; ++row) lanes_store_num(c + lane + lanes * row, load(state + lane + lanes * row));
        lanes_store_num(c + term * order + lane + lanes * quotient, none);
        lanes_store_num(c + term * order + lane + lanes * numerator, none);
        lanes_begin(has, lane, e, load(t + lane), load(side + lane), c + lane, 0, &of, c + lane, x + lane);
    }
    lanes_expand(has, joins, order, e, &of, c, x, 0);
}

static void expand_affected_lanes(int order, const struct motion_kinds *which, const double *constants, const double *t,
                                  const double *side, const double *state, double *c, double *x) {
    const struct lanes_constants *const e = (const struct lanes_constants *)constants;
#define expand_as(has, joins) lanes_expand_with(has, joins, order, e, t, side, state, c, x)
    for_single_effects(build_kinds);
    // The others have no place in lanes.
    const struct motion_kinds any = {
        .rotor = which->rotor, .frame = which->frame, .torque = which->torque, .push = which->push, .drags = which->drags};
    expand_as(&any, 0);
#undef expand_as
}

#include "algebra_end.h"
