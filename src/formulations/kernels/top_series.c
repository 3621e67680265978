// Taylor coefficients of the motion of a symmetric top; see space_frame.f90, which has the equations. C with vectors:
// all components of a term are one vector, and the terms stay in registers where there are enough of them.
//
// Each level of the processor has its build: levels.h includes this file once for each, with LEVEL set.

#ifndef LEVEL

#include <string.h>

// As many numbers in a term as there are state variables, as in capabilities.f90; the place of the height among
// them, by which all are multiplied; and the highest order.
enum { numbers = 8, height = 6, highest = 30 };

typedef void expand_top_t(int order, const double *linear, const double *weight, const double *share,
                          const double *state, const double *rate, double fall, double *c);
expand_top_t spintop_expand_top;
int spintop_expand_top_at(int level, int order, const double *linear, const double *weight, const double *share,
                          const double *state, const double *rate, double fall, double *c);
int spintop_processor_level(void);

// Vectors wider than those of the processor are no arguments of functions that are called.
#pragma GCC diagnostic ignored "-Wpsabi"

#define LEVELS_OF "top_series.c"
#include "levels.h"

static expand_top_t *const built[] = BUILDS(expand);

static expand_top_t *chosen;

__attribute__((constructor)) static void choose(void) { chosen = built[spintop_processor_level()]; }

void spintop_expand_top(int order, const double *linear, const double *weight, const double *share,
                        const double *state, const double *rate, double fall, double *c) {
    chosen(order, linear, weight, share, state, rate, fall, c);
}

// The same at a level, for tests; returns whether there is a build for it.
int spintop_expand_top_at(int level, int order, const double *linear, const double *weight, const double *share,
                          const double *state, const double *rate, double fall, double *c) {
    if (!HAS_BUILD(built, level)) return 0;
    built[level](order, linear, weight, share, state, rate, fall, c);
    return 1;
}

#else

#define width LEVEL(width)
#define parts LEVEL(parts)
#define vector LEVEL(vector)
#define series LEVEL(series)
#define get LEVEL(get)
#define keep LEVEL(keep)
#define add_term LEVEL(add_term)
#define expand LEVEL(expand)

// A row of numbers lies in one vector, or in more where the processor has no room for it in one.
enum { parts = numbers / width };
typedef double vector __attribute__((vector_size(8 * width)));

// The terms, and the height in each; and the factors of a term and of its products in the next but one.
struct series {
    vector term[highest + 1][parts];
    double height[highest + 1];
    vector linear[parts], weight[parts], start[parts];
};

#define inlined static inline __attribute__((always_inline))
#if defined(__clang__)
#define for_parts _Pragma("clang loop unroll(full)") for (int p = 0; p < parts; ++p)
#define unrolled
#else
#define for_parts _Pragma("GCC unroll 4") for (int p = 0; p < parts; ++p)
#define unrolled _Pragma("GCC unroll 16")
#endif

inlined void get(vector *v, const double *from) {
    for_parts memcpy(&v[p], from + width * p, sizeof *v);
}

// Keeps term k, and puts it to the results without its height.
inlined void keep(struct series *s, int k, const vector *term, double *c) {
    double *const row = c + numbers * k;
    for_parts {
        s->term[k][p] = term[p];
        memcpy(row + width * p, &term[p], sizeof *term);
    }
    s->height[k] = term[height / width][height % width];
    row[height] = 0;
}

// Term k + 2: products of the terms 0 to k, and a factor of term k. The newest terms come last.
inlined void add_term(struct series *s, int k, double share, double *c) {
    vector sum[parts], more[parts], now[parts], next[parts];
    for_parts sum[p] = more[p] = (vector){0};
    unrolled for (int j = k / 2; j > 0; --j) for_parts sum[p] += s->height[j] * s->term[k - j][p];
    unrolled for (int j = k / 2 + 1; j < k; ++j) for_parts more[p] += s->height[j] * s->term[k - j][p];
    for_parts now[p] = (share * s->weight[p]) * (sum[p] + more[p]);
    for_parts now[p] += (share * s->linear[p]) * s->term[k][p];
    for_parts next[p] = now[p] + s->height[k] * (share * s->start[p]);
    keep(s, k + 2, next, c);
}

// From the state, whose height counts as zero, its rate, and the second derivative of the height.
static void expand(int order, const double *linear, const double *weight, const double *share, const double *state,
                   const double *rate, double fall, double *c) {
    struct series s;
    vector term[parts];
    get(s.linear, linear), get(s.weight, weight);
    get(term, state);
    term[height / width][height % width] = 0;
    keep(&s, 0, term, c);
    for_parts s.start[p] = s.weight[p] * term[p];
    for_parts term[p] *= share[0] * s.linear[p];
    term[height / width][height % width] = share[0] * fall;
    keep(&s, 2, term, c);
    get(term, rate);
    keep(&s, 1, term, c);
#if defined(__AVX__) && !defined(__clang__)
    // Without loops, so that no branch depends on the number of terms but the one that ends.
#define after(k)                                                                                                       \
    if ((k) + 2 > order) return;                                                                                       \
    add_term(&s, k, share[k], c);
    after(1) after(2) after(3) after(4) after(5) after(6) after(7) after(8) after(9) after(10) after(11) after(12)
    after(13) after(14) after(15) after(16) after(17) after(18) after(19) after(20) after(21) after(22) after(23)
    after(24) after(25) after(26) after(27) after(28)
#undef after
#else
    for (int k = 1; k + 2 <= order; ++k) add_term(&s, k, share[k], c);
#endif
}

#undef width
#undef parts
#undef vector
#undef series
#undef get
#undef keep
#undef add_term
#undef expand
#undef inlined
#undef for_parts
#undef unrolled

#endif
