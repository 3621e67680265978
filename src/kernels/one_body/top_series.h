// Taylor coefficients of the motion of a symmetric top; see space_frame.f90, which has the equations. C with vectors:
// all components of a term are one vector, and the terms stay in registers where there are enough of them.
//
// All variables have poles at the same complex times, simple ones but for the height v, which is 2/(t - t*)^2 there. So D with
// D' = w D, w' = -v/2, D(0) = 1 and w(0) = 0 has zeros there and no poles, and the products of D and the variables have none
// either: their series converge everywhere (series_terms.h). The results are the terms of the variables, and in the place of
// the height those of D. Long steps leave more rounding than short ones: for the finest tolerances, which have the highest
// orders, D is not used, and 0.

// The place of the height in a term, by which all are multiplied.
enum { height = 6 };

// The highest order at which D is used: that of the tolerance 1e-12.
static const int highest_quotient = 26;

// Rates of the state and of the height, the second derivative of the height, and the factors of the linear terms, each as the
// sum of two numbers. A factor that is rounded in the same way in every step makes energy and momentum drift.
struct top_start {
    double rate[numbers], linear[numbers], linear_rest[numbers], fall;
};

#define real double
#define find_start find_start_in_double
#include "top_start.h"
#undef real
#undef find_start

// The same for the finest tolerances, where rounding is not less than the error of a step.
#if LDBL_MANT_DIG == 64
#define real long double
#else
#define real double // of few digits, or of many but without the help of the processor
#endif
#define find_start find_start_with_rests
#include "top_start.h"
#undef real
#undef find_start

// The terms, and the height in each; the terms of D and of w; and the factors of a term and of its products in the
// next but one.
struct top_terms {
    vector term[highest_order + 1][parts];
    double height[highest_order + 1], denominator[highest_order + 1], slope[highest_order + 1];
    vector linear[parts], linear_rest[parts], weight[parts], start[parts];
    int is_quotient;
};

#if defined(__clang__)
#define unrolled_far_for for
#else
#define unrolled_far_for _Pragma("GCC unroll 16") for
#endif

// Keeps term k.
inlined void keep_term(struct top_terms *s, int k, const vector *term) {
    for_all(p, parts) s->term[k][p] = term[p];
    s->height[k] = term[height / width][height % width];
}

// Term k + 2: products of the terms 0 to k, and a factor of term k. The newest terms come last.
inlined void add_top_term(struct top_terms *s, int k, struct share share) {
    vector sum[parts], more[parts], now[parts], next[parts];
    for_all(p, parts) sum[p] = more[p] = (vector){0};
    unrolled_far_for(int j = k / 2; j > 0; --j)
        for_all(p, parts) sum[p] += s->height[j] * s->term[k - j][p];
    unrolled_far_for(int j = k / 2 + 1; j < k; ++j)
        for_all(p, parts) more[p] += s->height[j] * s->term[k - j][p];
    for_all(p, parts) now[p] = s->weight[p] * scaled(sum[p] + more[p], share);
    for_all(p, parts) now[p] += scaled(s->linear[p], share) * s->term[k][p];
    if (!s->is_quotient)
        for_all(p, parts) now[p] += scaled(s->linear_rest[p], share) * s->term[k][p];
    for_all(p, parts) next[p] = now[p] + s->height[k] * scaled(s->start[p], share);
    keep_term(s, k + 2, next);
}

// Term k + 2 of the denominator D: D' = w D, w' = -v/2. `share` is 1/((k + 1) (k + 2)).
inlined void add_denominator(struct top_terms *s, int k, double share) {
    double even = 0, odd = 0;
    s->slope[k + 1] = -(share * (k + 2)) / 2 * s->height[k];
    unrolled_far_for(int j = 2; j <= k + 1; j += 2) even += s->slope[j] * s->denominator[k + 1 - j];
    unrolled_far_for(int j = 3; j <= k + 1; j += 2) odd += s->slope[j] * s->denominator[k + 1 - j];
    s->denominator[k + 2] = share * (k + 1) * (even + odd);
}

// Puts term k to the results, with that of D in the place of its height.
inlined void put_term(const struct top_terms *s, int k, double *c) {
    for_all(p, parts) store(c + numbers * k + width * p, s->term[k][p]);
    c[numbers * k + height] = s->is_quotient ? s->denominator[k] : 0;
}

// Makes term k + 2, and puts it to the results.
inlined void make_term(struct top_terms *s, int k, struct share share, double *c) {
    add_top_term(s, k, share);
    if (s->is_quotient) add_denominator(s, k, share.first);
    put_term(s, k + 2, c);
}

static void expand_top(int order, const struct symmetric_top *top, const double *state, const double *share,
                       const double *share_rest, double *c) {
    // Factors of the products of v with L, p and v.
    static const double weight[numbers] = {1, 1, 1, 1, 1, 1, 3, 0};
    struct top_terms s;
    vector term[parts];
    s.is_quotient = order <= highest_quotient;
    const struct top_start start = s.is_quotient ? find_start_in_double(top, state) : find_start_with_rests(top, state);
    get_parts(s.linear, start.linear), get_parts(s.linear_rest, start.linear_rest), get_parts(s.weight, weight);
    get_parts(term, state);
    term[height / width][height % width] = 0;
    keep_term(&s, 0, term);
    for_all(p, parts) s.start[p] = s.weight[p] * term[p];
    for_all(p, parts) term[p] = share[0] * s.linear[p] * term[p] + share[0] * s.linear_rest[p] * term[p];
    term[height / width][height % width] = share[0] * start.fall;
    keep_term(&s, 2, term);
    get_parts(term, start.rate);
    keep_term(&s, 1, term);
    s.denominator[0] = 1, s.denominator[1] = s.denominator[2] = 0, s.slope[1] = 0;
    for_all(k, 3) put_term(&s, k, c);
    int k = 1;
#if defined(__AVX__) && !defined(__clang__)
    // The first terms without loops, so that no branch depends on their number but the one that ends: with all of them the
    // instructions would not fit the cache.
#define after(k)                 \
    if ((k) + 2 > order) return; \
    make_term(&s, k, share_of(share, share_rest, k), c);
    // clang-format off
    after(1) after(2) after(3) after(4) after(5) after(6) after(7) after(8) after(9) after(10) after(11) after(12)
    after(13) after(14) after(15) after(16) after(17) after(18) after(19)
    k = 20;
    // clang-format on
#undef after
#endif
    for (; k + 2 <= order; ++k) make_term(&s, k, share_of(share, share_rest, k), c);
}
