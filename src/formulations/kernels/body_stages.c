// Stages of a Runge-Kutta step for one body; see rigid_body_stages.f90, which has the equations. C with vectors, as a
// stage waits for the one before it: quaternion and momentum are one vector, and its rate is four products of vectors.
//
// Each level of the processor has its build: levels.h includes this file once for each, with LEVEL set.

#ifndef LEVEL

#include <string.h>

// As many numbers in a state as in capabilities.f90.
enum { numbers = 8 };

// Constants of the equations, as rigid_body_stages.f90 has them: inverse moments of inertia, what couples the momenta, the
// moment of the weight, damping over inertia.
struct body {
    double mobility[3], coupling[3], moment[3], decay[3];
};

// Finds the stages `from` to `to`, counted from zero, of a step of size h; column i of `a` has the weights of those before
// it, `stride` apart. The vertical in body axes is that of a quaternion whose norm stays as it is in y.
typedef void find_stages_t(int from, int to, const struct body *body, const double *y, double h, const double *a,
                           int stride, double *k);
find_stages_t spintop_find_stages;
int spintop_find_stages_at(int level, int from, int to, const struct body *body, const double *y, double h,
                           const double *a, int stride, double *k);
int spintop_processor_level(void);

// Vectors wider than those of the processor are no arguments of functions that are called.
#pragma GCC diagnostic ignored "-Wpsabi"

#define LEVELS_OF "body_stages.c"
#include "levels.h"

static find_stages_t *const built[] = BUILDS(find_stages);

static find_stages_t *chosen;

__attribute__((constructor)) static void choose(void) { chosen = built[spintop_processor_level()]; }

void spintop_find_stages(int from, int to, const struct body *body, const double *y, double h, const double *a,
                         int stride, double *k) {
    chosen(from, to, body, y, h, a, stride, k);
}

// The same at a level, for tests; returns whether there is a build for it.
int spintop_find_stages_at(int level, int from, int to, const struct body *body, const double *y, double h,
                           const double *a, int stride, double *k) {
    if (!HAS_BUILD(built, level)) return 0;
    built[level](from, to, body, y, h, a, stride, k);
    return 1;
}

#else

#define find_stages LEVEL(find_stages)

#if defined(__AVX512F__)

#define vector LEVEL(vector)
#define bits LEVEL(bits)
#define shuffle __builtin_shufflevector

typedef double vector __attribute__((vector_size(8 * numbers)));
typedef long long bits __attribute__((vector_size(8 * numbers)));

static void find_stages(int from, int to, const struct body *body, const double *y, double h, const double *a, int stride,
                        double *k) {
    const double *v = body->mobility, *s = body->coupling, *d = body->decay;
    const double norm = (y[0] * y[0] + y[3] * y[3]) + (y[1] * y[1] + y[2] * y[2]), twice = 2 / norm;
    const double r1 = twice * body->moment[0], r2 = twice * body->moment[1], r3 = twice * body->moment[2];
    // y is (q0 q1 q2 q3 P1 P2 P3 .). The first half of each product is one of the three in the rate of q; the last is
    // P x P, and the torque with half the vertical (g1 g2 g3) as (g2 g3 g1) and (g3 g1 g2).
    const vector first = {-v[0] / 2, v[0] / 2, v[1] / 2, v[2] / 2, s[0], s[1], s[2], 0};
    const vector second = {-v[1] / 2, v[2] / 2, v[0] / 2, v[1] / 2, 0, 0, 0, 0};
    const vector third = {-v[2] / 2, -v[1] / 2, -v[2] / 2, -v[0] / 2, 0, 0, 0, 0};
    const vector pull = {0, 0, 0, 0, r3, r1, r2, 0}, swing = {0, 0, 0, 0, -r2, -r3, -r1, 0};
    const vector decay = {0, 0, 0, 0, -d[0], -d[1], -d[2], 0};
    const vector up_second = {0, 0, 0, 0, 0, -norm / 2, 0, 0}, up_third = {0, 0, 0, 0, -norm / 2, 0, 0, 0};
    const vector one = {1, 1, 1, 1, 1, 1, 1, 1}, none = {0};
    const vector sign_second = {0, 0, 0, 0, 0, 0, -0.0, 0}, sign_third = {0, 0, 0, 0, 0, -0.0, 0, 0};
    vector start, newest;
    memcpy(&start, y, sizeof start), memcpy(&newest, k + numbers * (from - 1), sizeof newest);
    for (int i = from; i <= to; ++i) {
        const double *weight = a + (long)stride * i;
        vector even = none, odd = none, older;
        int j = 0;
        // The newest stage comes last, as all others are known before it.
        for (; j + 2 < i; j += 2) {
            memcpy(&older, k + numbers * j, sizeof older), even += weight[j] * older;
            memcpy(&older, k + numbers * (j + 1), sizeof older), odd += weight[j + 1] * older;
        }
        if (j + 1 < i) memcpy(&older, k + numbers * j, sizeof older), even += weight[j] * older;
        const vector now = (start + h * (even + odd)) + (h * weight[i - 1]) * newest;
        const vector q3 = shuffle(now, one, 8, 8, 8, 8, 3, 3, 3, 3), q0 = shuffle(now, none, 8, 8, 8, 8, 0, 0, 0, 0);
        const vector q0_second = (vector)((bits)q0 ^ (bits)sign_second), q0_third = (vector)((bits)q0 ^ (bits)sign_third);
        const vector a2 = q3 * shuffle(now, now, 2, 2, 3, 1, 2, 3, 1, 0)
                          + (q0_second * shuffle(now, now, 1, 1, 1, 1, 1, 0, 2, 0) + up_second);
        const vector a3 = q3 * shuffle(now, now, 3, 3, 1, 2, 3, 1, 2, 0)
                          + (q0_third * shuffle(now, now, 1, 1, 1, 1, 0, 2, 1, 0) + up_third);
        const vector b1 = first * shuffle(now, now, 4, 4, 5, 6, 6, 4, 5, 7);
        const vector b2 = second * shuffle(now, now, 5, 6, 4, 5, 5, 5, 5, 7) + pull;
        const vector b3 = third * shuffle(now, now, 6, 5, 6, 4, 6, 6, 6, 7) + swing;
        const vector rate = (decay * now + shuffle(now, now, 1, 0, 0, 0, 5, 6, 4, 7) * b1) + a2 * b2;
        newest = rate + a3 * b3;
        memcpy(k + numbers * i, &newest, sizeof newest);
    }
}

#undef vector
#undef bits
#undef shuffle

#else

static void find_stages(int from, int to, const struct body *body, const double *y, double h, const double *a, int stride,
                        double *k) {
    const double *v = body->mobility, *s = body->coupling, *r = body->moment, *d = body->decay;
    const double twice = 2 / ((y[0] * y[0] + y[3] * y[3]) + (y[1] * y[1] + y[2] * y[2]));
    for (int i = from; i <= to; ++i) {
        const double *weight = a + (long)stride * i;
        const double *newest = k + numbers * (i - 1);
        double now[numbers] = {0}, *rate = k + numbers * i;
        for (int j = 0; j + 1 < i; ++j) {
            for (int n = 0; n < numbers; ++n) now[n] += weight[j] * k[numbers * j + n];
        }
        // The newest stage comes last, as all others are known before it.
        for (int n = 0; n < numbers; ++n) now[n] = (y[n] + h * now[n]) + (h * weight[i - 1]) * newest[n];
        const double q0 = now[0], q1 = now[1], q2 = now[2], q3 = now[3], p1 = now[4], p2 = now[5], p3 = now[6];
        const double w1 = v[0] * p1 / 2, w2 = v[1] * p2 / 2, w3 = v[2] * p3 / 2;
        const double g1 = twice * (q1 * q3 - q0 * q2), g2 = twice * (q2 * q3 + q0 * q1);
        const double g3 = twice * (q0 * q0 + q3 * q3) - 1;
        rate[0] = -(q1 * w1 + q2 * w2 + q3 * w3);
        rate[1] = q0 * w1 + q2 * w3 - q3 * w2;
        rate[2] = q0 * w2 + q3 * w1 - q1 * w3;
        rate[3] = q0 * w3 + q1 * w2 - q2 * w1;
        rate[4] = s[0] * p2 * p3 + (g2 * r[2] - g3 * r[1]) - d[0] * p1;
        rate[5] = s[1] * p3 * p1 + (g3 * r[0] - g1 * r[2]) - d[1] * p2;
        rate[6] = s[2] * p1 * p2 + (g1 * r[1] - g2 * r[0]) - d[2] * p3;
        rate[7] = 0;
    }
}

#endif

#undef find_stages

#endif
