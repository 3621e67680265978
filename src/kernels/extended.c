// The closed form of one symmetric top in extended precision, for turning_points.f90 and circular_form.f90. Components as
// there, where the kind of numbers is that of long double.

#include <float.h>
#include <math.h>

#if LDBL_MANT_DIG < 64
#error "the closed form of tops needs a long double of 64 binary digits or more"
#endif

typedef long double real;
#define inlined static inline
typedef int truth;
static const real pi = 3.14159265358979323846264338327950288L;
enum { laguerre_steps = 60, newton_steps = 30 };
#define unrolled

inlined int any_of(truth condition) { return condition; }
inlined real choose(truth condition, real a, real b) { return condition ? a : b; }
inlined real less_of(real a, real b) { return a < b ? a : b; }
inlined real greater_of(real a, real b) { return a > b ? a : b; }
inlined real magnitude(real x) { return fabsl(x); }
inlined real square_root(real x) { return sqrtl(x); }
inlined real with_sign(real a, real b) { return copysignl(a, b); }
inlined real argument_of(real x, real y) { return atan2l(y, x); }
// 0/0 = 0: the limits of the exact solution at rest, at a pole and without gravity.
inlined real divided(real a, real b) { return choose(magnitude(a) > 0, a / b, 0); }
inlined real inverse(real b) { return choose(magnitude(b) > 0, 1 / b, 0); }
// Only rounding errors carry an iterate past a root to which the steps lead from one side.
inlined int has_settled(real step, real x, real onward, int *returns) {
    *returns += onward < 0;
    return !(magnitude(step) > 4 * (real)LDBL_EPSILON * magnitude(x)) || *returns > 3;
}

#include "closed_form/closed_form.h"

// Highest multiple of 2z in the series, of which the next term is at most 4e-17, and rows of the table of polynomials in cos
// 2z.
enum { last = 3, table_rows = 16 };
enum { upper_even, upper_odd, lower_even, lower_odd };
enum { upper_even_slope = lower_odd + 1, upper_odd_slope, lower_even_slope, lower_odd_slope };
enum { sn = lower_odd_slope + 1, cn, divisor, divisor_slope };

struct clock {
    real start, rate, period, half_period, per_period, upper_rate, lower_rate, sum_rate, upper_step, lower_step;
    double upper_amplitude, lower_amplitude;
};
struct circular_form {
    double upper_least, lower_least, powers[last + 1][table_rows];
};

void spintop_find_roots(const struct start *start, struct roots *roots) {
    truth doubt = 0;
    find_roots_at_turning_point(start, roots);
    if (start->g0 > 0) find_roots_of_moving(start, roots, &doubt);
    find_moduli(start, roots);
}

// Nome q = exp(-pi K'/K) from k^2 <= 0.971 and k'.
real spintop_nome(real k2, real kc) {
    const real root = 1 + square_root(kc);
    return nome_of(k2 / (2 * (1 + kc) * root * root));
}

// U = upper_least - [sin(z)^2 even + i sin(2z) odd], L = lower_least - [cos(z)^2 even + i sin(2z) odd], and their derivatives;
// the polynomials of the upper pole are in -cos 2z. `way` is 1 for the lower pole and -1 for the upper one.
static void tabulate_pole(const struct pole *pole, int way, int even_row, int even_slope, double (*powers)[table_rows]) {
    real even[last + 2] = {0}, odd[last + 2] = {0};
    for (int k = 0, sign = 1; k < last; ++k, sign *= way) {
        even[k] = -2 * sign * pole->even[k];
        odd[k] = -way * sign * pole->side * pole->odd[k];
    }
    for (int k = 0; k <= last; ++k) {
        powers[k][even_row] = (double)even[k];
        powers[k][even_row + 1] = (double)odd[k];
        powers[k][even_slope] = (double)((k + 1) * (way * even[k] - even[k + 1]));
        powers[k][even_slope + 1] = (double)(2 * ((k ? k * odd[k - 1] : 0) - (k + 1) * odd[k + 1]));
    }
}

// W = theta_4 and its derivative; sn W = theta_3/theta_2 sum (-1)^n q^(n(n+1)) sin (2n+1)z, in which sin (2n+1)z = sin z [1 +
// 2 sum_{m<=n} cos 2mz]. cn likewise from the top.
static void tabulate_functions(real q, real root_kc, real theta3, double (*powers)[table_rows]) {
    const real q2 = q * q, q4 = q2 * q2, q6 = q2 * q4, w1 = -2 * q, w2 = 2 * q4, w3 = -2 * q4 * q4 * q;
    const real whole[last + 2] = {1 - w2, w1 - 3 * w3, 2 * w2, 4 * w3};
    const real t0 = theta3 / (1 + q2 + q6 + q6 * q6), t1 = -q2 * t0, t2 = q6 * t0, t3 = -q6 * q6 * t0;
    const real a1 = 2 * (t1 + t2 + t3), a2 = 2 * (t2 + t3), a3 = 2 * t3;
    const real sine[last + 1] = {t0 + t1 + t2 + t3 - a2, a1 - 3 * a3, 2 * a2, 4 * a3};
    for (int k = 0; k <= last; ++k) {
        powers[k][sn] = (double)sine[k];
        powers[k][cn] = (double)root_kc * (k % 2 ? -powers[k][sn] : powers[k][sn]);
        powers[k][divisor] = (double)whole[k];
        powers[k][divisor_slope] = (double)(2 * (k + 1) * whole[k + 1]);
    }
}

// Clock and table of a motion with k^2 <= 1/2.
void spintop_prepare_circular(const struct start *start, const struct roots *roots, struct clock *clock,
                              struct circular_form *form) {
    struct thetas f;
    truth doubt = 0;
    find_nome(start, roots, &f);
    find_positions(&f, &doubt);
    place_pole(f.q, &f.bottom), place_pole(f.q, &f.top);
    find_rates(start, roots, &f);
    *clock = (struct clock){
        .start = argument_at_start(start, roots, &f, position_at_start(roots, &f, &doubt)),
        .rate = f.z_rate,
        .period = pi,
        .half_period = pi / 2,
        .per_period = 1 / pi,
        .upper_rate = f.upper_rate,
        .lower_rate = f.lower_rate,
        .sum_rate = f.sum_rate,
        .upper_amplitude = (double)(square_root(f.bottom.weight / 2) * f.theta3),
        .lower_amplitude = (double)(square_root(f.top.weight / 2) * f.theta3),
    };
    *form = (struct circular_form){(double)f.bottom.nearest, (double)f.top.nearest, {{0}}};
    tabulate_pole(&f.bottom, 1, upper_even, upper_even_slope, form->powers);
    tabulate_pole(&f.top, -1, lower_even, lower_even_slope, form->powers);
    tabulate_functions(f.q, f.root_kc, f.theta3, form->powers);
}
