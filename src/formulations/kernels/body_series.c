// Taylor coefficients of the motion of one body; see rigid_body_series.f90, which has the equations. C with
// vectors, as no Fortran compiler makes vectors of the products of one body: each term of the series is kept in
// six arrangements, so that all products of two terms are three products of vectors.
//
// Each level of the processor has its build: levels.h includes this file once for each, with LEVEL set.

#ifndef LEVEL

#include <string.h>

// As many numbers in a term as there are state variables, as in capabilities.f90; and terms, at most.
enum { numbers = 8, half = numbers / 2, most_terms = 31 };

// Constants of the equations: factors of the products of vectors in body_vectors.h, as body_products.f90 finds them.
struct body {
    double first[numbers], second[numbers], third[numbers], decay[numbers], pull[numbers], swing[numbers];
};

typedef void expand_body_t(int order, const struct body *body, const double *state, const double *share, double *c);
expand_body_t spintop_expand_body;
int spintop_expand_body_at(int level, int order, const struct body *body, const double *state, const double *share,
                           double *c);
int spintop_processor_level(void);

// Vectors wider than those of the processor are no arguments of functions that are called.
#pragma GCC diagnostic ignored "-Wpsabi"

#define LEVELS_OF "body_series.c"
#include "levels.h"

static expand_body_t *const built[] = BUILDS(expand);

static expand_body_t *chosen;

__attribute__((constructor)) static void choose(void) { chosen = built[spintop_processor_level()]; }

void spintop_expand_body(int order, const struct body *body, const double *state, const double *share, double *c) {
    chosen(order, body, state, share, c);
}

// The same at a level, for tests; returns whether there is a build for it.
int spintop_expand_body_at(int level, int order, const struct body *body, const double *state, const double *share,
                           double *c) {
    if (!HAS_BUILD(built, level)) return 0;
    built[level](order, body, state, share, c);
    return 1;
}

#else

#define expand LEVEL(expand)

#include "body_vectors.h"
#include "body_start.h"

static void expand(int order, const struct body *body, const double *state, const double *share, double *c) {
    struct factors row[most_terms], start, next, f;
    struct inner_sums later;
    vector first[parts], second[parts], third[parts], decay[parts], pull[parts], swing[parts];
    vector now[parts], both[parts], rate[parts], ahead[parts], torque[2][parts], by_torque[2][parts];
    vector s1[parts], s2[parts];
    half_vector q, momentum, vertical;

    get(first, body->first), get(second, body->second), get(third, body->third);
    get(decay, body->decay), get(pull, body->pull), get(swing, body->swing);
    find_first_term(state, &q, &momentum, &vertical);
    from_halves(&momentum, &vertical, now);
    memcpy(c, state, numbers * sizeof *c);
    arrange(now, &q, &f, torque);
    for_parts {
        start.a0[p] = first[p] * f.b0[p], start.b0[p] = first[p] * f.a0[p];
        start.a1[p] = second[p] * f.b1[p], start.b1[p] = second[p] * f.a1[p];
        start.a2[p] = third[p] * f.b2[p], start.b2[p] = third[p] * f.a2[p];
        rate[p] = start.a0[p] * f.a0[p] + (pull[p] * torque[0][p] - swing[p] * torque[1][p] - decay[p] * now[p]);
        s1[p] = start.a1[p] * f.a1[p], s2[p] = start.a2[p] * f.a2[p];
        by_torque[0][p] = pull[p], by_torque[1][p] = -swing[p];
        ahead[p] = (vector){0};
    }
    add_last_half(by_torque[0], start.a1), add_last_half(by_torque[1], start.b1);
    add_last_half(rate, s1);
    for_parts now[p] = rate[p];
    q = sum_of_halves(s1, s2);
    for_parts s1[p] = s2[p] = (vector){0};

    for (int k = 1;; ++k) {
        // `now` and `q` are term k; `ahead`, `s1` and `s2` the products of the terms 1 to k - 1.
        arrange(now, &q, &f, torque);
        momentum = first_half(now);
        from_halves(&q, &momentum, both);
        for_parts memcpy(c + numbers * k + width * p, &both[p], sizeof *both);
        if (k == order) return;
        for_parts {
            s1[p] += start.b1[p] * f.b1[p], s2[p] += start.b2[p] * f.b2[p];
            s1[p] += start.a1[p] * f.a1[p], s2[p] += start.a2[p] * f.a2[p];
            rate[p] = ((ahead[p] - decay[p] * now[p]) + start.a0[p] * f.a0[p] + by_torque[1][p] * torque[1][p])
                      + (start.b0[p] * f.b0[p] + by_torque[0][p] * torque[0][p]);
            now[p] = share[k] * rate[p];
        }
        q = share[k] * sum_of_halves(s1, s2);
        // What the next term needs of those before it does not wait for that.
        if (k + 1 == order) continue;
        if (k == 1) {
            for_parts {
                next.a0[p] = first[p] * f.b0[p], next.b0[p] = first[p] * f.a0[p];
                next.a1[p] = second[p] * f.b1[p], next.b1[p] = second[p] * f.a1[p];
                next.a2[p] = third[p] * f.b2[p], next.b2[p] = third[p] * f.a2[p];
                ahead[p] = next.a0[p] * f.a0[p];
                s1[p] = next.a1[p] * f.a1[p], s2[p] = next.a2[p] * f.a2[p];
            }
            add_last_half(ahead, s1);
            continue;
        }
        for_parts {
            ahead[p] = next.a0[p] * f.a0[p] + next.b0[p] * f.b0[p];
            s1[p] = next.a1[p] * f.a1[p] + next.b1[p] * f.b1[p];
            s2[p] = next.a2[p] * f.a2[p] + next.b2[p] * f.b2[p];
        }
        for_parts f.a0[p] *= first[p], f.a1[p] *= second[p], f.a2[p] *= third[p];
        row[k] = f;
        add_inner_products(k, row, ahead, s1, s2, &later);
        add_last_half(ahead, s1);
    }
}

#endif
