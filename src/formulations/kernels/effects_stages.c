// Stages of a Runge-Kutta step for one body with effects; see effects_stages.f90, which has the equations. As body_stages.c,
// with what effects add.
//
// Each level of the processor has its build: levels.h includes this file once for each, with LEVEL set.

#ifndef LEVEL

#include <math.h>
#include <string.h>

// As many numbers in a state as in capabilities.f90.
enum { numbers = 8, half = numbers / 2 };

// Up to this angle, rad, cosines and sines are short series.
static const double small_angle = 0.8;

// Constants of the equations, as effects_stages.f90 has them. The pivot's acceleration in space axes is
// `swing[0] cos(rate t) + swing[1] sin(rate t)`.
struct effects {
    double mobility[half], coupling[half], damping[half], weight[half], arm[half], drag[half], torque_body[half];
    double rotor[half], drive[half], torque_space[half], frame[half], swing[2][half];
    double gravity, drag_power, drag_force, rate;
    int has_sides, has_rotor, has_drag, vibrates, turns;
};

// Finds the stages `from` to `to`, counted from zero, of a step of size h from the time t; column i of `a` has the weights of
// those before it, `stride` apart, and c[i] its time in the step. The quaternion keeps the norm that it has in y.
typedef void find_effects_t(int from, int to, const struct effects *e, double t, const double *y, double h, const double *a,
                            int stride, const double *c, double *k);
find_effects_t spintop_find_effects_stages;
int spintop_processor_level(void);

// Vectors wider than those of the processor are no arguments of functions that are called.
#pragma GCC diagnostic ignored "-Wpsabi"

#define LEVELS_OF "effects_stages.c"
#include "levels.h"

static find_effects_t *const built[] = BUILDS(find_effects);

static find_effects_t *chosen;

__attribute__((constructor)) static void choose(void) { chosen = built[spintop_processor_level()]; }

void spintop_find_effects_stages(int from, int to, const struct effects *e, double t, const double *y, double h,
                                 const double *a, int stride, const double *c, double *k) {
    chosen(from, to, e, t, y, h, a, stride, c, k);
}

#else

#define row LEVEL(row)
#define vector LEVEL(vector)
#define get LEVEL(get)
#define cross LEVEL(cross)
#define pivot_at LEVEL(pivot_at)
#define slope LEVEL(slope)
#define find_effects LEVEL(find_effects)
#define shuffle __builtin_shufflevector
#define inlined static inline __attribute__((always_inline))
#define component(v, i) shuffle(v, v, i, i, i, i)

typedef double row __attribute__((vector_size(8 * numbers)));
typedef double vector __attribute__((vector_size(8 * half)));

inlined vector get(const double *from) {
    vector v;
    memcpy(&v, from, sizeof v);
    return v;
}

// The vector product.
inlined vector cross(const vector *first, const vector *last) {
    const vector a = *first, b = *last, c = a * shuffle(b, b, 1, 2, 0, 3) - shuffle(a, a, 1, 2, 0, 3) * b;
    return shuffle(c, c, 1, 2, 0, 3);
}

// The acceleration of the pivot in space axes, at an angle after that for which `swing` is. The series of both functions are
// cut off below 1e-19 where the angle is small; this costs less than half of what their calls do.
inlined vector pivot_at(const vector swing[2], double x) {
    const double z = -x * x;
    double even = 1, odd = 1;
    if (!(-z < small_angle * small_angle)) {
        even = cos(x), odd = sin(x);
    } else {
        _Pragma("GCC unroll 9") for (int n = 18; n > 0; n -= 2) {
            even = 1 + z * (1.0 / (n * (n - 1))) * even, odd = 1 + z * (1.0 / (n * (n + 1))) * odd;
        }
        odd *= x;
    }
    return even * swing[0] + odd * swing[1];
}

// The rate of the quaternion q and of the momentum p at a time; `twice` is twice the inverse of the squared norm of q,
// `push` the acceleration of the pivot in space axes.
inlined row slope(const struct effects *e, double t, const vector *push, const vector *attitude, const vector *momentum,
                  double twice) {
    const vector q = *attitude, p = *momentum, q0 = component(q, 0), imaginary = shuffle(q, q, 1, 2, 3, 0);
    const vector third = {0, 0, 1}, weight = get(e->weight), arm = get(e->arm);
    const vector g = twice * (component(q, 3) * imaginary + q0 * (shuffle(q, q, 2, 1, 0, 3) * (vector){-1, 1, 1, 0})) - third;
    const vector pivot = *push, torque = get(e->torque_space);
    vector rotor = {0}, u = p, lift = e->gravity * g, w, rate = get(e->torque_body);
    if (e->has_rotor) rotor = get(e->rotor) + t * get(e->drive), u -= rotor;
    const vector total = u * get(e->mobility);
    w = total;
    lift += component(pivot, 2) * g, rate += component(torque, 2) * g;
    if (e->has_sides) {
        const vector frame = get(e->frame), first = {1}, second = {0, 1};
        const vector x_by_q0 = shuffle(q, q, 0, 3, 2, 1) * (vector){1, -1, 1, 0};
        const vector y_by_q0 = shuffle(q, q, 3, 0, 1, 2) * (vector){1, 1, -1, 0};
        const vector x = twice * (component(q, 1) * imaginary + q0 * x_by_q0) - first;
        const vector y = twice * (component(q, 2) * imaginary + q0 * y_by_q0) - second;
        lift += component(pivot, 0) * x + component(pivot, 1) * y;
        rate += component(torque, 0) * x + component(torque, 1) * y;
        w -= component(frame, 0) * x + component(frame, 1) * y;
    }
    if (e->turns) w -= e->frame[2] * g;
    rate += get(e->coupling) * (shuffle(u, u, 1, 2, 0, 3) * shuffle(u, u, 2, 0, 1, 3)) + cross(&lift, &weight);
    if (e->has_rotor) rate += cross(&rotor, &total);
    rate -= get(e->damping) * w;
    if (e->has_drag) {
        const vector squares = w * w;
        const double square = squares[0] + squares[1] + squares[2];
        const double power = e->drag_power < 0.5 || e->drag_power > 0.5 ? pow(square, e->drag_power) : sqrt(square);
        rate -= power * (get(e->drag) * w);
    }
    if (e->drag_force > 0) {
        const vector v = cross(&w, &arm), squares = v * v;
        rate += e->drag_force * sqrt(squares[0] + squares[1] + squares[2]) * cross(&v, &arm);
    }
    const vector turn = component(w, 0) * ((vector){-0.5, 0.5, 0.5, -0.5} * shuffle(q, q, 1, 0, 3, 2))
                        + (component(w, 1) * ((vector){-0.5, -0.5, 0.5, 0.5} * shuffle(q, q, 2, 3, 0, 1))
                           + component(w, 2) * ((vector){-0.5, 0.5, -0.5, 0.5} * shuffle(q, q, 3, 2, 1, 0)));
    return shuffle(turn, rate, 0, 1, 2, 3, 4, 5, 6, 7);
}

static void find_effects(int from, int to, const struct effects *e, double t, const double *y, double h, const double *a,
                         int stride, const double *c, double *k) {
    const double twice = 2 / ((y[0] * y[0] + y[3] * y[3]) + (y[1] * y[1] + y[2] * y[2]));
    const double turned = e->rate * t;
    const row none = {0};
    vector swing[2] = {{0}}, pivot = {0};
    row start, newest = none;
    memcpy(&start, y, sizeof start);
    if (from > 0) memcpy(&newest, k + numbers * (from - 1), sizeof newest);
    if (e->vibrates) {
        const double even = cos(turned), odd = sin(turned);
        swing[0] = even * get(e->swing[0]) + odd * get(e->swing[1]);
        swing[1] = even * get(e->swing[1]) - odd * get(e->swing[0]);
    }
    for (int i = from; i <= to; ++i) {
        const double *weight = a + (long)stride * i;
        row even = none, odd = none, older, now = start;
        int j = 0;
        // The newest stage comes last, as all others are known before it.
        for (; j + 2 < i; j += 2) {
            memcpy(&older, k + numbers * j, sizeof older), even += weight[j] * older;
            memcpy(&older, k + numbers * (j + 1), sizeof older), odd += weight[j + 1] * older;
        }
        if (j + 1 < i) memcpy(&older, k + numbers * j, sizeof older), even += weight[j] * older;
        if (i > 0) now = (start + h * (even + odd)) + (h * weight[i - 1]) * newest;
        const vector q = shuffle(now, now, 0, 1, 2, 3), p = shuffle(now, none, 4, 5, 6, 8);
        if (e->vibrates) pivot = pivot_at(swing, e->rate * (c[i] * h));
        newest = slope(e, t + c[i] * h, &pivot, &q, &p, twice);
        newest[numbers - 1] = 0;
        memcpy(k + numbers * i, &newest, sizeof newest);
    }
}

#undef row
#undef vector
#undef get
#undef cross
#undef pivot_at
#undef slope
#undef find_effects
#undef shuffle
#undef inlined
#undef component

#endif
