// The series of bodies in lanes with effects, for a level of the processor.

#include "algebra_lanes.h"
#include "motion_series.h"

_Static_assert((int)lanes_rows == (int)rows && (int)lanes_more == (int)more_rows, "the rows are those of kernels.h");
_Static_assert((int)lanes_total == (int)total && (int)lanes_drags == (int)drags && (int)lanes_of_drag == (int)of_drag, "drags");

static void set_lane(const struct body_numbers *body, int lane, double *constants) {
    lanes_set(body, lane, (struct lanes_constants *)constants);
}

inlined void lanes_expand_with(const struct motion_kinds *has, int joins, int order, const struct lanes_constants *e,
                               const double *t, const double *side, const double *state, const double *share,
                               const double *share_rest, double *c, double *x) {
    struct lanes_start of;
    const vector none = {0};
    for (int lane = 0; lane < lanes; lane += width) {
        for (int row = w1; row <= angle; ++row) lanes_store_num(c + lane + lanes * row, load(state + lane + lanes * row));
        lanes_store_num(c + term * order + lane + lanes * quotient, none);
        lanes_store_num(c + term * order + lane + lanes * numerator, none);
        lanes_begin(has, lane, e, load(t + lane), load(side + lane), c + lane, 0, &of, c + lane, x + lane);
    }
    lanes_expand(has, joins, order, e, &of, share, share_rest, c, x, 0);
}

static void expand_affected_lanes(int order, const struct motion_kinds *which, const double *constants, const double *t,
                                  const double *side, const double *state, const double *share, const double *share_rest,
                                  double *c, double *x) {
    const struct lanes_constants *const e = (const struct lanes_constants *)constants;
    const struct motion_kinds any = {
        .rotor = which->rotor, .frame = which->frame, .torque = which->torque, .push = which->push, .drags = which->drags};
#define build_kind(...)                                                                    \
    {                                                                                      \
        const struct motion_kinds has = {__VA_ARGS__};                                     \
        if (memcmp(&has, &any, sizeof has) == 0) {                                         \
            lanes_expand_with(&has, 1, order, e, t, side, state, share, share_rest, c, x); \
            return;                                                                        \
        }                                                                                  \
    }
#define build_kinds(...) build_kind(__VA_ARGS__) build_kind(.rotor = 1, __VA_ARGS__)
    for_single_effects(build_kinds);
#undef build_kinds
#undef build_kind
    lanes_expand_with(&any, 0, order, e, t, side, state, share, share_rest, c, x);
}

#include "algebra_end.h"
