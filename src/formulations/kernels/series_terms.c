// What a step of Taylor's method does with the terms of a series: it finds its size, and the sum; see taylor.f90. In C
// with vectors, as the terms themselves are found: at low orders this is a quarter of a step.
//
// Each level of the processor has its build: levels.h includes this file once for each, with LEVEL set.

#ifndef LEVEL

#include <float.h>
#include <math.h>
#include <string.h>

// As many numbers in a term as there are state variables, as in capabilities.f90; and instants, as in motions.f90.
enum { numbers = 8, instants = 8 };

// Admissible errors of the variables, as in error_weight.f90.
struct weight {
    const double *absolute, *relative, *scale;
};

typedef double length_of_step_t(int order, const double *c, const struct weight *weight, double least, double h);
typedef void add_terms_t(int order, const double *c, double h, double *change);
typedef void add_terms_at_t(int order, const double *c, const double *h, double *change);
double spintop_length_of_step(int order, const double *c, const double *absolute, const double *relative,
                              const double *scale, double least, double h);
add_terms_t spintop_add_terms;
add_terms_at_t spintop_add_terms_at;
int spintop_processor_level(void);

// Vectors wider than those of the processor are no arguments of functions that are called.
#pragma GCC diagnostic ignored "-Wpsabi"

#define LEVELS_OF "series_terms.c"
#include "levels.h"

static length_of_step_t *const built_lengths[] = BUILDS(length_of_step);
static add_terms_t *const built_sums[] = BUILDS(add_terms);
static add_terms_at_t *const built_sums_at[] = BUILDS(add_terms_at);

static length_of_step_t *length_of_step;
static add_terms_t *add_terms;
static add_terms_at_t *add_terms_at;

__attribute__((constructor)) static void choose(void) {
    length_of_step = built_lengths[spintop_processor_level()];
    add_terms = built_sums[spintop_processor_level()];
    add_terms_at = built_sums_at[spintop_processor_level()];
}

// The time at which the larger of the last two terms reaches the admissible error; not finite if they are not.
double spintop_length_of_step(int order, const double *c, const double *absolute, const double *relative,
                              const double *scale, double least, double h) {
    const struct weight weight = {absolute, relative, scale};
    return length_of_step(order, c, &weight, least, h);
}

// The change after a time h: the sum of all terms but the first.
void spintop_add_terms(int order, const double *c, double h, double *change) { add_terms(order, c, h, change); }

// The changes after several times, of one variable after the other.
void spintop_add_terms_at(int order, const double *c, const double *h, double *change) { add_terms_at(order, c, h, change); }

#else

#define width LEVEL(width)
#define vector LEVEL(vector)
#define bits LEVEL(bits)
#define get LEVEL(get)
#define magnitude LEVEL(magnitude)
#define larger LEVEL(larger)
#define largest LEVEL(largest)
#define length_of_step LEVEL(length_of_step)
#define add_terms LEVEL(add_terms)
#define add_terms_at LEVEL(add_terms_at)

#include "binary_powers.h"

// A row of numbers lies in one vector, or in more where the processor has no room for it in one.
typedef double vector __attribute__((vector_size(8 * width)));
typedef long long bits __attribute__((vector_size(8 * width)));

static inline vector get(const double *from) {
    vector v;
    memcpy(&v, from, sizeof v);
    return v;
}

static inline vector magnitude(vector x) { return (vector)((bits)x & 0x7fffffffffffffffLL); }

static inline double larger(double a, double b) { return a > b ? a : b; }

static inline double largest(const double *v) {
    return larger(larger(larger(v[0], v[1]), larger(v[2], v[3])), larger(larger(v[4], v[5]), larger(v[6], v[7])));
}

static double length_of_step(int order, const double *c, const struct weight *weight, double least, double h) {
    double last[numbers], before[numbers];
    for (int i = 0; i < numbers; i += width) {
        // Near a zero of a component the magnitude one step away is used.
        const vector growth = magnitude(get(c + numbers + i)) * h, scale = get(weight->scale + i);
        const bits small = growth < scale;
        const vector more = (vector)(((bits)growth & small) | ((bits)scale & ~small));
        const vector share = 1 / (get(weight->absolute + i) + get(weight->relative + i) * (magnitude(get(c + i)) + more));
        const vector by_last = (magnitude(get(c + numbers * order + i)) + least) * share;
        const vector by_before = (magnitude(get(c + numbers * (order - 1) + i)) + least) * share;
        memcpy(last + i, &by_last, sizeof by_last), memcpy(before + i, &by_before, sizeof by_before);
    }
    const double most = largest(last), most_before = largest(before);
    if (!(most <= DBL_MAX && most_before <= DBL_MAX)) return most + most_before;
    return power_of_two(-larger(binary_logarithm(most) * (1.0 / order),
                                binary_logarithm(most_before) * (1.0 / (order - 1))));
}

// Horner's rule in four sums, of every fourth term each, as each waits for its last step. The order is 4 at least.
static void add_terms(int order, const double *c, double h, double *change) {
    const int top = order / 4 * 4, rest = order - top;
    const double h2 = h * h, h4 = h2 * h2;
    for (int i = 0; i < numbers; i += width) {
        const vector none = {0};
        const double *term = c + numbers * top + i;
        vector s0 = get(term), s1 = none, s2 = none, s3 = none;
        if (rest > 0) s1 = get(term + numbers);
        if (rest > 1) s2 = get(term + 2 * numbers);
        if (rest > 2) s3 = get(term + 3 * numbers);
        for (int k = top - 4; k >= 0; k -= 4) {
            term -= 4 * numbers;
            if (k > 0) s0 = s0 * h4 + get(term);
            s1 = s1 * h4 + get(term + numbers), s2 = s2 * h4 + get(term + 2 * numbers);
            s3 = s3 * h4 + get(term + 3 * numbers);
        }
        s0 = h * (s1 + h * s2) + h2 * (h * s3 + h2 * s0);
        memcpy(change + i, &s0, sizeof s0);
    }
}

// Horner's rule for all variables at once: the sums are as many as needed for none to wait.
static void add_terms_at(int order, const double *c, const double *h, double *change) {
    for (int i = 0; i < instants; i += width) {
        const vector time = get(h + i);
        vector s[numbers] = {{0}};
        for (int k = order; k > 0; --k) {
#pragma GCC unroll 8
            for (int n = 0; n < numbers; ++n) s[n] = s[n] * time + c[numbers * k + n];
        }
#pragma GCC unroll 8
        for (int n = 0; n < numbers; ++n) {
            s[n] *= time;
            memcpy(change + instants * n + i, &s[n], sizeof s[n]);
        }
    }
}

#undef width
#undef vector
#undef bits
#undef get
#undef magnitude
#undef larger
#undef largest
#undef binary_logarithm
#undef power_of_two
#undef length_of_step
#undef add_terms
#undef add_terms_at

#endif
