// The kernels for Fortran: of the tables of builds one is chosen when the program starts, by the level of the processor.

#include "kernels.h"

int spintop_processor_level(void);

#ifdef HAS_LEVELS
static const struct kernels *const built[] = {0, 0, &spintop_kernels_v2, &spintop_kernels_v3, &spintop_kernels_v4};
#else
#define KERNELS spintop_kernels_as_built
#include "kernels_of_level.h"
static const struct kernels *const built[] = {&spintop_kernels_as_built};
#endif

static struct kernels chosen;

__attribute__((constructor)) static void choose(void) { chosen = *built[spintop_processor_level()]; }

void spintop_expand_body(int order, const struct body_products *body, const double *state, const double *share, double *c) {
    chosen.expand_body(order, body, state, share, c);
}

void spintop_expand_top(int order, const double *linear, const double *weight, const double *share, const double *state,
                        const double *rate, double fall, double *c) {
    chosen.expand_top(order, linear, weight, share, state, rate, fall, c);
}

void spintop_expand_effects(int order, const struct series_effects *e, const double *state, const double *pivot,
                            const double *share, double *c, int *exists) {
    chosen.expand_effects(order, e, state, pivot, share, c, exists);
}

double spintop_length_of_step(int order, const double *c, const double *absolute, const double *relative, const double *scale,
                              double least, double h) {
    return chosen.length_of_step(order, c, absolute, relative, scale, least, h);
}

void spintop_add_terms(int order, const double *c, double h, double *change) { chosen.add_terms(order, c, h, change); }

void spintop_add_terms_at(int order, const double *c, const double *h, double *change) {
    chosen.add_terms_at(order, c, h, change);
}

void spintop_find_stages(int from, int to, const struct stage_factors *body, const double *y, double h, int stages,
                         const double *a, const int *since, double *k, double *aside) {
    chosen.find_stages(from, to, body, y, h, stages, a, since, k, aside);
}

void spintop_find_effects_stages(int from, int to, const struct stage_effects *e, double t, const double *y, double h,
                                 const double *a, int stride, const double *c, double *k) {
    chosen.find_effects_stages(from, to, e, t, y, h, a, stride, c, k);
}

double spintop_sum_stages(int since, int stages, const double *weight, const double *k, const double *y, const double *rest,
                          double h, const double *absolute, const double *relative, int states, double most, double share,
                          double *change, double *y_new, double *growth) {
    return chosen.sum_stages(since, stages, weight, k, y, rest, h, absolute, relative, states, most, share, change, y_new,
                             growth);
}

void spintop_expand_lanes(int order, const struct lane_body *b, const double *side, const double *state, const double *share,
                          const double *share_rest, double *c) {
    chosen.expand_lanes(order, b, side, state, share, share_rest, c);
}

void spintop_carry_tangents(int order, const struct lane_body *b, const double *c, const double *duration, const double *pace,
                            int number, const int *which, int free, const struct lane_body *change, const double *before,
                            double *after, double *whole, double *last) {
    chosen.carry_tangents(order, b, c, duration, pace, number, which, free, change, before, after, whole, last);
}

void spintop_expand_affected_lanes(int order, const struct lane_kinds *has, const struct lane_constants *e, const double *t,
                                   const double *side, const double *state, const double *share, const double *share_rest,
                                   double *c, double *x) {
    chosen.expand_affected_lanes(order, has, e, t, side, state, share, share_rest, c, x);
}

void spintop_add_lane_work(int order, const struct lane_kinds *has, const int *acts, const struct lane_work *of,
                           const double *duration, const double *c, const double *x, double *done) {
    chosen.add_lane_work(order, has, acts, of, duration, c, x, done);
}

void spintop_multiply_lanes(int degree, const double *x, const double *y, double *product) {
    chosen.multiply_lanes(degree, x, y, product);
}

void spintop_multiply_slopes(int degree, const double *x, const double *y, double *product) {
    chosen.multiply_slopes(degree, x, y, product);
}

void spintop_square_lanes(int degree, const double *x, double *product) { chosen.square_lanes(degree, x, product); }

void spintop_find_force_slopes(int degree, const struct lane_arm *arm, const double *power, const double *c, double *slope,
                               double *first) {
    chosen.find_force_slopes(degree, arm, power, c, slope, first);
}

void spintop_find_changes(int n, const double *share, double rounding, const double *a, double *noise, double *sign,
                          double *changes, double *near) {
    chosen.find_changes(n, share, rounding, a, noise, sign, changes, near);
}

void spintop_refine_root(int n, int iterations, double still, const double *a, double *u, double *doubt) {
    chosen.refine_root(n, iterations, still, a, u, doubt);
}

// The same at a level, for tests; returns whether there is a build for it.

static const struct kernels *builds_at(int level) {
    return level >= 0 && level < (int)(sizeof built / sizeof *built) ? built[level] : 0;
}

int spintop_expand_body_at(int level, int order, const struct body_products *body, const double *state, const double *share,
                           double *c);
int spintop_expand_body_at(int level, int order, const struct body_products *body, const double *state, const double *share,
                           double *c) {
    const struct kernels *const at = builds_at(level);
    if (at) at->expand_body(order, body, state, share, c);
    return at != 0;
}

int spintop_expand_top_at(int level, int order, const double *linear, const double *weight, const double *share,
                          const double *state, const double *rate, double fall, double *c);
int spintop_expand_top_at(int level, int order, const double *linear, const double *weight, const double *share,
                          const double *state, const double *rate, double fall, double *c) {
    const struct kernels *const at = builds_at(level);
    if (at) at->expand_top(order, linear, weight, share, state, rate, fall, c);
    return at != 0;
}

int spintop_find_stages_at(int level, int from, int to, const struct stage_factors *body, const double *y, double h, int stages,
                           const double *a, const int *since, double *k, double *aside);
int spintop_find_stages_at(int level, int from, int to, const struct stage_factors *body, const double *y, double h, int stages,
                           const double *a, const int *since, double *k, double *aside) {
    const struct kernels *const at = builds_at(level);
    if (at) at->find_stages(from, to, body, y, h, stages, a, since, k, aside);
    return at != 0;
}

int spintop_expand_lanes_at(int level, int order, const struct lane_body *b, const double *side, const double *state,
                            const double *share, const double *share_rest, double *c);
int spintop_expand_lanes_at(int level, int order, const struct lane_body *b, const double *side, const double *state,
                            const double *share, const double *share_rest, double *c) {
    const struct kernels *const at = builds_at(level);
    if (at) at->expand_lanes(order, b, side, state, share, share_rest, c);
    return at != 0;
}

int spintop_find_changes_at(int level, int n, const double *share, double rounding, const double *a, double *noise,
                            double *sign, double *changes, double *near);
int spintop_find_changes_at(int level, int n, const double *share, double rounding, const double *a, double *noise,
                            double *sign, double *changes, double *near) {
    const struct kernels *const at = builds_at(level);
    if (at) at->find_changes(n, share, rounding, a, noise, sign, changes, near);
    return at != 0;
}

int spintop_refine_root_at(int level, int n, int iterations, double still, const double *a, double *u, double *doubt);
int spintop_refine_root_at(int level, int n, int iterations, double still, const double *a, double *u, double *doubt) {
    const struct kernels *const at = builds_at(level);
    if (at) at->refine_root(n, iterations, still, a, u, doubt);
    return at != 0;
}
