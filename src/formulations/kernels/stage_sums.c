// The sums of the stages of a Runge-Kutta step with two embedded methods, and what they say of its error; see dop853.f90. In C
// with vectors, as the stages themselves are found: from state to state this would be half of a step.
//
// Each level of the processor has its build: levels.h includes this file once for each, with LEVEL set.

#ifndef LEVEL

#include <float.h>
#include <math.h>
#include <string.h>

// As many numbers in a state as in capabilities.f90.
enum { numbers = 8 };

// Weights of a stage in the change of the state, with the rounding error of that, and in the errors of the embedded methods.
struct weights {
    double change, rest, fifth, third;
};

// What errors are compared to, as in error_weight.f90, and the powers of two by which the next step grows: `most` if the error
// is the tolerance, and less by `share` of the logarithm of the error.
struct control {
    const double *absolute, *relative;
    int states;
    double most, share;
};

typedef double sum_stages_t(int since, int stages, const struct weights *weight, const double *k, const double *y,
                            const double *rest, double h, const struct control *control, double *change, double *y_new,
                            double *growth);
double spintop_sum_stages(int since, int stages, const struct weights *weight, const double *k, const double *y,
                          const double *rest, double h, const double *absolute, const double *relative, int states,
                          double most, double share, double *change, double *y_new, double *growth);
int spintop_processor_level(void);

#define LEVELS_OF "stage_sums.c"
#include "levels.h"

static sum_stages_t *const built[] = BUILDS(sum_stages);

static sum_stages_t *chosen;

__attribute__((constructor)) static void choose(void) { chosen = built[spintop_processor_level()]; }

// The change of the state over a step of size h, the state after it, with the rounding error `rest` of that before, and the
// logarithm to base 2 of its error in units of the tolerance: the root mean square over the states of the errors of the
// embedded methods, combined to an estimate of order h^8. It is not finite if they are not. `growth` is the factor from this
// step to the next. The stages that enter are the first and those from `since` on, counted from one.
double spintop_sum_stages(int since, int stages, const struct weights *weight, const double *k, const double *y,
                          const double *rest, double h, const double *absolute, const double *relative, int states,
                          double most, double share, double *change, double *y_new, double *growth) {
    const struct control control = {absolute, relative, states, most, share};
    return chosen(since, stages, weight, k, y, rest, h, &control, change, y_new, growth);
}

#else

#define width LEVEL(width)
#define vector LEVEL(vector)
#define bits LEVEL(bits)
#define get LEVEL(get)
#define total LEVEL(total)
#define sum_stages LEVEL(sum_stages)

#include "binary_powers.h"

// A row of numbers lies in one vector, or in more where the processor has no room for it in one.
typedef double vector __attribute__((vector_size(8 * width)));
typedef long long bits __attribute__((vector_size(8 * width)));

static inline vector get(const double *from) {
    vector v;
    memcpy(&v, from, sizeof v);
    return v;
}

static inline double total(const double *v) {
    return ((v[0] + v[4]) + (v[1] + v[5])) + ((v[2] + v[6]) + (v[3] + v[7]));
}

static double sum_stages(int since, int stages, const struct weights *weight, const double *k, const double *y,
                         const double *rest, double h, const struct control *control, double *change, double *y_new,
                         double *growth) {
    double squares[2][numbers];
    for (int i = 0; i < numbers; i += width) {
        vector slope = get(k + i);
        vector main = weight->change * slope, lost = weight->rest * slope;
        vector fifth = weight->fifth * slope, third = weight->third * slope;
        for (int j = since - 1; j < stages; ++j) {
            const struct weights *w = weight + j;
            slope = get(k + numbers * j + i);
            main += w->change * slope, lost += w->rest * slope;
            fifth += w->fifth * slope, third += w->third * slope;
        }
        const vector before = get(y + i), step = h * (main + lost), after = before + (step + get(rest + i));
        const vector a = (vector)((bits)before & 0x7fffffffffffffffLL), b = (vector)((bits)after & 0x7fffffffffffffffLL);
        const bits grows = a < b;
        const vector magnitude = (vector)(((bits)b & grows) | ((bits)a & ~grows));
        const vector share = 1 / (get(control->absolute + i) + get(control->relative + i) * magnitude);
        fifth *= share, third *= share;
        fifth *= fifth, third *= third;
        memcpy(change + i, &step, sizeof step), memcpy(y_new + i, &after, sizeof after);
        memcpy(squares[0] + i, &fifth, sizeof fifth), memcpy(squares[1] + i, &third, sizeof third);
    }
    const double fifth = h * h * total(squares[0]), both = (fifth + h * h * 0.01 * total(squares[1])) * control->states;
    if (!(fifth <= DBL_MAX && both <= DBL_MAX)) return fifth + both;
    // Of no error: about -500.
    const double error = binary_logarithm(fifth) - 0.5 * binary_logarithm(both);
    *growth = power_of_two(control->most - control->share * error);
    return error;
}

#undef width
#undef vector
#undef bits
#undef get
#undef total
#undef sum_stages
#undef binary_logarithm
#undef power_of_two

#endif
