// Stages of a Runge-Kutta step for one body; see rigid_body_stages.f90, which has the equations. C with vectors of three or
// four components, as a stage waits for the one before it: the angular velocity and the vertical wait for themselves only,
// and the quaternion follows beside.
//
// Each level of the processor has its build: levels.h includes this file once for each, with LEVEL set.

#ifndef LEVEL

#include <string.h>

// As many numbers in a state, and set aside by a stage, as in capabilities.f90.
enum { numbers = 8, half = numbers / 2, set_aside = 3 * half };

// Constants of the equations, as rigid_body_stages.f90 has them.
struct body {
    double inertia[half], mobility[half], coupling[half], decay[half], pull[half], swing[half];
};

// The weights of the stages: column i of `a`, `stages` apart, has those before stage i, of which the first and those from
// number since[i] - 1 on are not zero.
struct weights {
    int stages;
    const double *a;
    const int *since;
};

// Finds the stages `from` to `to`, counted from zero, of a step of size h from y. Row i of k is the slope of quaternion and
// momentum. Row i of `aside` is the change of quaternion, angular velocity and vertical at this slope, over the step;
// the rows before `from` are known, but row 0 is found here.
typedef void find_stages_t(int from, int to, const struct body *body, const double *y, double h, const struct weights *weights,
                           double *k, double *aside);
void spintop_find_stages(int from, int to, const struct body *body, const double *y, double h, int stages, const double *a,
                         const int *since, double *k, double *aside);
int spintop_find_stages_at(int level, int from, int to, const struct body *body, const double *y, double h, int stages,
                           const double *a, const int *since, double *k, double *aside);
int spintop_processor_level(void);

// Vectors wider than those of the processor are no arguments of functions that are called.
#pragma GCC diagnostic ignored "-Wpsabi"

#define LEVELS_OF "body_stages.c"
#include "levels.h"

static find_stages_t *const built[] = BUILDS(find_stages);

static find_stages_t *chosen;

__attribute__((constructor)) static void choose(void) { chosen = built[spintop_processor_level()]; }

void spintop_find_stages(int from, int to, const struct body *body, const double *y, double h, int stages, const double *a,
                         const int *since, double *k, double *aside) {
    const struct weights weights = {stages, a, since};
    chosen(from, to, body, y, h, &weights, k, aside);
}

// The same at a level, for tests; returns whether there is a build for it.
int spintop_find_stages_at(int level, int from, int to, const struct body *body, const double *y, double h, int stages,
                           const double *a, const int *since, double *k, double *aside) {
    const struct weights weights = {stages, a, since};
    if (!HAS_BUILD(built, level)) return 0;
    built[level](from, to, body, y, h, &weights, k, aside);
    return 1;
}

#else

#define find_stages LEVEL(find_stages)
#define constants LEVEL(constants)
#define variables LEVEL(variables)
#define half_bits LEVEL(half_bits)
#define get_half LEVEL(get_half)
#define get_row LEVEL(get_row)
#define put_row LEVEL(put_row)
#define add LEVEL(add)
#define find_changes LEVEL(find_changes)

#include "body_vectors.h"
#include "body_start.h"

typedef unsigned long long half_bits __attribute__((vector_size(8 * half)));

// Those of the body, and 1 and 1/2, times the size of the step.
struct constants {
    half_vector one, half, coupling, decay, pull, swing;
};

// The quaternion, the angular velocity, and the vertical in body axes; or their changes.
struct variables {
    half_vector q, w, g;
};

inlined half_vector get_half(const double *from) {
    half_vector v;
    memcpy(&v, from, sizeof v);
    return v;
}

inlined struct variables get_row(const double *row) {
    return (struct variables){get_half(row), get_half(row + half), get_half(row + 2 * half)};
}

inlined void put_row(double *row, const struct variables *v) {
    put(row, &v->q), put(row + half, &v->w), put(row + 2 * half, &v->g);
}

inlined void add(struct variables *sum, double weight, const struct variables *v) {
    sum->q += weight * v->q, sum->w += weight * v->w, sum->g += weight * v->g;
}

// The changes at the rates of a state, over the step.
inlined struct variables find_changes(const struct constants *of, const struct variables *now) {
    const half_vector q = now->q, w = now->w, g = now->g, turn = of->one * w, roll = of->half * w;
    const half_vector w_ahead = shuffle(w, w, 1, 2, 0, 3), w_behind = shuffle(w, w, 2, 0, 1, 3);
    const half_vector g_ahead = shuffle(g, g, 1, 2, 0, 3), g_behind = shuffle(g, g, 2, 0, 1, 3);
    const half_vector turn_ahead = shuffle(turn, turn, 1, 2, 0, 3), turn_behind = shuffle(turn, turn, 2, 0, 1, 3);
    const half_vector rolled = shuffle(q, q, 1, 0, 0, 0) * shuffle(roll, roll, 0, 0, 1, 2)
                               + shuffle(q, q, 2, 2, 3, 1) * shuffle(roll, roll, 1, 2, 0, 1);
    const half_bits sign = {1ULL << 63, 0, 0, 0};
    return (struct variables){
        .q = (half_vector)((half_bits)rolled ^ sign) - shuffle(q, q, 3, 3, 1, 2) * shuffle(roll, roll, 2, 1, 2, 0),
        .w = ((of->coupling * w_behind) * w_ahead - of->decay * w) + (of->pull * g_ahead - of->swing * g_behind),
        .g = g_ahead * turn_behind - g_behind * turn_ahead,
    };
}

static void find_stages(int from, int to, const struct body *body, const double *y, double h, const struct weights *weights,
                        double *k, double *aside) {
    const half_vector one = {1, 1, 1, 1}, inertia = get_half(body->inertia) / h;
    const double share = 1 / h;
    const struct constants of = {h * one, h / 2 * one, h * get_half(body->coupling), h * get_half(body->decay),
                                 h * get_half(body->pull), h * get_half(body->swing)};
    struct variables start, newest;
    half_vector momentum;
    vector slope[parts];

    find_first_term(y, &start.q, &momentum, &start.g);
    start.w = get_half(body->mobility) * momentum;
    if (from == 1) {
        newest = find_changes(&of, &start);
        put_row(aside, &newest);
    }
    newest = get_row(aside + set_aside * (from - 1));
    for (int i = from; i <= to; ++i) {
        const double *weight = weights->a + (long)weights->stages * i;
        struct variables now = start, older;
        // The newest stage comes last, as all others are known before it.
        if (i > 1) older = get_row(aside), add(&now, weight[0], &older);
        for (int j = weights->since[i] - 1; j < i - 1; ++j) {
            older = get_row(aside + set_aside * j), add(&now, weight[j], &older);
        }
        add(&now, weight[i - 1], &newest);
        newest = find_changes(&of, &now);
        put_row(aside + set_aside * i, &newest);
        const half_vector q_slope = share * newest.q, p_slope = inertia * newest.w;
        from_halves(&q_slope, &p_slope, slope);
        for_parts memcpy(k + numbers * i + width * p, &slope[p], sizeof *slope);
    }
}

#undef find_stages

#endif
