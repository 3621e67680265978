// Symmetric tops by the closed form, one in each lane. The stages are loops over a strip of vectors, in which a lane does not
// know of its neighbours. They are short: a processor begins the next vector while it waits for roots and quotients of this one
// only as far ahead as a few hundred instructions. A top that they may not compute to the accuracy of exact_block.f90 is in
// doubt.

typedef vector real;
typedef bits truth;
static const double pi = 3.14159265358979323846;
enum { laguerre_steps = 4, newton_steps = 2 };
#if defined(__clang__)
#define unrolled _Pragma("clang loop unroll(full)")
#else
#define unrolled _Pragma("GCC unroll 16")
#endif

inlined int any_of(truth condition) {
    long long all = 0;
    for_all(lane, width) all |= condition[lane];
    return all != 0;
}
inlined real choose(truth condition, real a, real b) { return (real)((condition & (bits)a) | (~condition & (bits)b)); }
#if defined(__AVX512F__)
#define of_vector(name, ...) (real) _mm512_##name(__VA_ARGS__)
typedef __m512d operand;
#elif defined(__AVX__)
#define of_vector(name, ...) (real) _mm256_##name(__VA_ARGS__)
typedef __m256d operand;
#elif defined(__SSE2__)
#define of_vector(name, ...) (real) _mm_##name(__VA_ARGS__)
typedef __m128d operand;
#endif
#if defined(of_vector)
inlined real less_of(real a, real b) { return of_vector(min_pd, (operand)a, (operand)b); }
inlined real greater_of(real a, real b) { return of_vector(max_pd, (operand)a, (operand)b); }
inlined real square_root(real x) { return of_vector(sqrt_pd, (operand)x); }
#else
inlined real less_of(real a, real b) { return choose(a < b, a, b); }
inlined real greater_of(real a, real b) { return choose(a > b, a, b); }
inlined real square_root(real x) {
    for (int i = 0; i < width; ++i) x[i] = sqrt(x[i]);
    return x;
}
#endif
inlined real with_sign(real a, real b) { return (real)((bits)a | ((bits)b & ~0x7fffffffffffffffLL)); }
// Of 0/0 follows NaN: such a top is in doubt.
inlined real divided(real a, real b) { return a / b; }
inlined real inverse(real b) { return 1 / b; }
// All steps are made; the last one tells how far off the result may be.
inlined int has_settled(real step, real x, real onward, const int *returns) {
    return (void)step, (void)x, (void)onward, (void)returns, 0;
}

// (atan(x) - x)/x^3 in powers of x^2, x^2 <= 1: the polynomial that interpolates at Chebyshev points, weighted for relative
// error.
static const double arctangents[] = {
    -3.3333333333333330252e-1, 1.9999999999997532204e-1, -1.4285714285384131545e-1, 1.1111111093490828096e-1,
    -9.0909085908919342252e-2, 7.692298971033216917e-2,  -6.6665646992891042112e-2, 5.8815068777936560666e-2,
    -5.257973334284110807e-2,  4.7377495795277789723e-2, -4.2603566326016521328e-2, 3.7494868125352471116e-2,
    -3.127718906699638479e-2,  2.3696731580048622013e-2, -1.5535152475414176125e-2, 8.3689311784501621357e-3,
    -3.49588597391630952e-3,   1.0496035084968515073e-3, -1.9996189377901382062e-4, 1.8061954618612152202e-5};

// The argument of x + i y in [-pi/2, pi/2], x >= 0; NaN for 0. The error is below 4e-16, relative.
inlined real argument_of(real x, real y) {
    const real size = magnitude(y), slope = less_of(x, size) / greater_of(x, size), t = slope * slope, t2 = t * t;
    real even = (real){0}, odd = even;
    for_all(k, 10) even = arctangents[18 - 2 * k] + t2 * even, odd = arctangents[19 - 2 * k] + t2 * odd;
    const real a = slope + slope * t * (even + t * odd);
    return with_sign(choose(size <= x, a, pi / 2 - a), y);
}

// The inclination in [0, pi] of a sine, which is not negative, and a cosine.
inlined real inclination_of(real sine, real cosine) {
    const real a = argument_of(magnitude(cosine), sine);
    return choose(cosine < 0, pi - a, a);
}

#include "closed_form.h"

// A top: the position and the argument at its start, the sum and the difference of the arguments of the theta functions, as
// they turn phi and psi, at the start and at an instant, and there sin 2z, (cos(z)^2 - sin(z)^2)^2, sine and cosine of the
// inclination, and the values of Theta, the imaginary part without its sign.
struct top {
    struct start start;
    struct roots roots;
    struct thetas f;
    real position, z0, phi_start, psi_start, phi_now, psi_now, sine_2z, square, sine, cosine, bottom_re, bottom_im, top_re,
        top_im;
    truth doubt, doubt_before;
};

// Vectors in a strip: enough to fill the processor, few enough for its first cache.
enum { strip = 32 / width };

// b - a (b + a) is no smaller in terms of those whose difference it is, and the square of a theta function in terms of its
// largest: closer to a pole phi and psi vary fast. Largest nome for which the series are complete to 1e-15, and largest
// argument.
static const double least_difference = 1.0e-2, least_theta = 1.0e-5, largest_nome = 0.27, largest_angle = 1.0e6;
// As in pole_passages.f90.
static const double through_pole = 0x1p-35;

inlined real norm_of(real re, real im) { return re * re + im * im; }
inlined truth is_finite(real x) { return magnitude(x) <= DBL_MAX; }

inlined void begin_top(const struct exact_block *b, int i, struct top *t) {
    const real theta = load(b->theta + i), phi_rate = load(b->phi_rate + i), theta_rate = load(b->theta_rate + i);
    const real inertia = load(b->inertia1 + i), per_inertia = 1 / inertia, mgl = load(b->mgl + i),
               inertia3 = load(b->inertia3 + i);
    struct start *const s = &t->start;
    real cosine, sine;
    find_circle_of_few_turns(theta / 2, &cosine, &sine);
    const real c2 = cosine * cosine, s2 = sine * sine, u0 = c2 - s2, square = 4 * s2 * c2;
    s->a = inertia3 * load(b->omega3 + i) * per_inertia, s->beta = 2 * mgl * per_inertia;
    s->below = 2 * s2, s->above = 2 * c2, s->turn = square * phi_rate;
    s->swing = theta_rate * theta_rate + s->turn * phi_rate;
    s->b_minus_a = s->below * (s->above * phi_rate - s->a), s->b_plus_a = s->above * (s->below * phi_rate + s->a);
    s->u_rate = -theta_rate;
    s->g0 = square * theta_rate * theta_rate;
    s->g1 = square * (2 * phi_rate * (s->a - u0 * phi_rate) - s->beta) - 2 * u0 * theta_rate * theta_rate;
    s->g2 = 2 * s->beta * u0 - s->swing - s->a * s->a;
    t->doubt = ~((inertia > 0) & (inertia3 >= 0) & (mgl >= 0) & (theta > 0) & (theta < pi)
                 & (magnitude(s->b_minus_a) > least_difference * (magnitude(s->turn) + s->below * magnitude(s->a)))
                 & (magnitude(s->b_plus_a) > least_difference * (magnitude(s->turn) + s->above * magnitude(s->a))));
}

// The quantities of a whole nutation.
inlined void put_nutation(struct exact_block *b, int i, struct top *t) {
    const struct start *const s = &t->start;
    const struct roots *const r = &t->roots;
    const struct thetas *const f = &t->f;
    // b - a u at the turning points, in the form that cancels least, and phi' there.
    const real at_top = s->a * r->y2, to_top = s->a * r->d2, at_bottom = s->a * r->y1, to_bottom = s->a * r->p1;
    const real top_turn = choose(magnitude(s->turn) + magnitude(at_top) <= magnitude(s->b_minus_a) + magnitude(to_top),
                                 s->turn - at_top, s->b_minus_a + to_top);
    const real bottom_turn = choose(magnitude(s->turn) + magnitude(at_bottom) <= magnitude(s->b_plus_a) + magnitude(to_bottom),
                                    s->turn - at_bottom, s->b_plus_a - to_bottom);
    const real per_both = 1 / (r->d2 * r->p1);
    const real top_rate = top_turn * r->per_p2 * r->p1 * per_both;
    const real bottom_rate = bottom_turn * r->per_m1 * r->d2 * per_both;
    const real rate = choose(magnitude(top_rate) > magnitude(bottom_rate), top_rate, bottom_rate);
    const real root_mp = square_root(r->m1 * r->p2), cosine_min = (r->p2 - r->d2) / 2, u_min = (r->p1 - r->m1) / 2;
    const real sine_min = r->root_md * root_mp * r->per_m1;
    const real sine_max = magnitude(s->b_plus_a) * r->per_root_p3 * root_mp * r->per_p2;
    const real period = 4 * pi * f->theta3 * f->theta3 * r->frequency * r->per_beta_u;
    // If the start is at a turning point, its inclination is one of the angles.
    const truth moves = s->g0 > 0, is_top = ~(moves | (r->y1 < 0));
    const real angle = inclination_of(choose(is_top, sine_min, sine_max), choose(is_top, cosine_min, u_min));
    real other = load(b->theta + i);
    if (any_of(moves)) other = choose(moves, inclination_of(sine_min, cosine_min), other);
    store(b->theta_min + i, less_of(angle, other));
    store(b->theta_max + i, greater_of(angle, other));
    store(b->u_min + i, u_min);
    store(b->delta_u + i, r->d);
    store(b->period + i, period);
    store(b->precession + i, f->sum_rate * period);
    store(b->precession_rate + i, f->sum_rate);
    store(b->phi_rate_max + i, rate);
    // Passages through a pole are counted one by one. The comparison is also false for NaN and infinity.
    t->doubt |= ~(
        (f->q <= largest_nome) & (sine_min > through_pole) & (sine_max > through_pole)
        & is_finite(sine_min + sine_max + r->d + period + f->sum_rate * period + rate + f->upper_rate - f->lower_rate));
}

// Theta at an instant: `near` is sin(z)^2 or cos(z)^2, whichever vanishes where the axis is nearest to the pole.
inlined void evaluate_pole(const struct pole *p, real near, real far, real sine_2z, real *re, real *im) {
    const real c = far - near;
    real even = p->even[4], odd = p->odd[4];
    for_all(n, 4) even = p->even[3 - n] + c * even, odd = p->odd[3 - n] + c * odd;
    *re = p->nearest + 2 * near * even, *im = sine_2z * odd;
}

// The theta functions of both poles at a time since the start; then their arguments.
inlined void find_thetas(struct top *t, real time) {
    struct thetas *const f = &t->f;
    const real z = t->z0 + f->z_rate * time;
    real cosine, sine;
    find_circle_of_few_turns(z, &cosine, &sine);
    const real c2 = cosine * cosine, s2 = sine * sine, sine_2z = 2 * sine * cosine;
    evaluate_pole(&f->bottom, s2, c2, sine_2z, &t->bottom_re, &t->bottom_im);
    evaluate_pole(&f->top, c2, s2, sine_2z, &t->top_re, &t->top_im);
    t->sine_2z = sine_2z, t->square = (c2 - s2) * (c2 - s2);
    t->doubt |= ~((magnitude(z) <= largest_angle)
                  & (norm_of(t->bottom_re, t->bottom_im) > least_theta * f->bottom.farthest * f->bottom.farthest)
                  & (norm_of(t->top_re, t->top_im) > least_theta * f->top.farthest * f->top.farthest));
}
inlined void find_phases(struct top *t) {
    const real bottom = t->f.bottom.side * argument_of(t->bottom_re, t->bottom_im);
    const real top = t->f.top.side * argument_of(t->top_re, t->top_im);
    t->phi_now = bottom - top, t->psi_now = bottom + top;
}

// The argument at the start, and the phases there. From a turning point it is known, and they are zero; what the stages for
// others find is not for it, nor their doubt.
inlined void begin_at_turning_point(struct top *t) {
    const real zero = {0};
    t->z0 = choose(t->roots.y1 < 0, zero + pi / 2, zero), t->phi_start = t->psi_start = zero;
}
inlined void find_start_position(struct top *t) {
    t->doubt_before = t->doubt;
    t->position = position_at_start(&t->roots, &t->f, &t->doubt);
}
inlined void find_start_argument(struct top *t) {
    t->z0 = choose(t->start.g0 > 0, argument_at_start(&t->start, &t->roots, &t->f, t->position), t->z0);
}
inlined void keep_start_phases(struct top *t) {
    const truth moves = t->start.g0 > 0;
    t->phi_start = choose(moves, t->phi_now, t->phi_start), t->psi_start = choose(moves, t->psi_now, t->psi_start);
    t->doubt = t->doubt_before | (moves & t->doubt);
}

// The motion at the end of the span.
static void put_end(struct exact_block *b, int i, struct top *t) {
    const struct start *const s = &t->start;
    const struct thetas *const f = &t->f;
    const real omega3 = load(b->omega3 + i), time = load(b->t_end + i);
    // u' is a theta function of twice the argument, over theta_4(z)^4.
    const real q2 = f->q * f->q, q6 = q2 * q2 * q2, q12 = q6 * q6, q20 = q12 * q6 * q2, v = 4 * t->square;
    const real series = 1 - q2 * (v - 1) + q6 * (v * (v - 3) + 1) - q12 * (v * (v * (v - 5) + 6) - 1)
                        + q20 * (v * (v * (v * (v - 7) + 15) - 10) + 1);
    const real theta2 = 1 + q2 + q6 + q12 + q20;
    // 1 + u and 1 - u, but for a common factor: their sum is 2.
    const real plus = f->bottom.weight * norm_of(t->bottom_re, t->bottom_im);
    const real minus = f->top.weight * norm_of(t->top_re, t->top_im);
    const real root = square_root(plus * minus), both = (plus + minus) * root, energy = s->swing + s->a * omega3 + s->beta;
    const real per_all = 1 / (both * theta2 * energy), per_both = per_all * theta2 * energy, per_sum = root * per_both;
    const real sine = 2 * plus * minus * per_both, cosine = (plus - minus) * per_sum;
    const real swing = 2 * t->roots.d * t->roots.frequency * t->roots.kc * f->root_kc;
    const real theta_rate = -swing * series * t->sine_2z * per_both * per_all * energy * both;
    // phi' sin(theta)^2 from the nearer pole; phi' sin(theta) is this over the sine.
    const real turn = choose(cosine > 0, s->b_minus_a + s->a * (2 * minus * per_sum),
                             s->b_plus_a - s->a * (2 * plus * per_sum));
    const real y = choose(cosine > 0, s->below - 2 * minus * per_sum, 2 * plus * per_sum - s->above);
    const real across = turn * (plus + minus) * (plus + minus) * per_both / 2;
    const real error = magnitude(theta_rate * theta_rate - s->swing + s->beta * y + across * across)
                       * (per_all * both * theta2);
    const real phi = load(b->phi + i) + (f->sum_rate * time + (t->phi_now - t->phi_start));
    const real psi_rate = (omega3 - s->a) + (f->upper_rate - f->lower_rate);
    const real psi = load(b->psi + i) + (psi_rate * time + (t->psi_now - t->psi_start));
    t->sine = sine, t->cosine = cosine;
    store(b->phi_end + i, phi);
    store(b->psi_end + i, psi);
    store(b->theta_rate_end + i, theta_rate);
    store(b->energy_error + i, error);
    t->doubt |= ~is_finite(sine + theta_rate + error + phi + psi);
}

inlined void put_inclination(struct exact_block *b, int i, const struct top *t) {
    store(b->theta_end + i, inclination_of(t->sine, t->cosine));
}

// Change of phi until the other time.
inlined void put_period(struct exact_block *b, int i, struct top *t) {
    const real phi = t->f.sum_rate * load(b->t_period + i) + (t->phi_now - t->phi_start);
    store(b->phi_at_period + i, phi);
    t->doubt |= ~is_finite(phi);
}

static void find_tops(int wants_end, int wants_period, struct exact_block *b) {
    struct top tops[strip];
    double *const data = b->inertia1;
    // The last vector is filled with copies of the last case.
    for (int row = 0; row < block_data; ++row)
        for (int i = b->n; i % width; ++i) data[block_size * row + i] = data[block_size * row + b->n - 1];
#define for_strip for (int k = 0, i = first; k < strip && i < b->n; ++k, i += width)
    for (int first = 0; first < b->n; first += strip * width) {
        truth moves = {0};
        for_strip begin_top(b, i, &tops[k]);
        for_strip moves |= tops[k].start.g0 > 0;
        for_strip find_roots_at_turning_point(&tops[k].start, &tops[k].roots);
        if (any_of(moves)) for_strip find_roots_of_moving(&tops[k].start, &tops[k].roots, &tops[k].doubt);
        for_strip find_moduli(&tops[k].start, &tops[k].roots);
        for_strip find_nome(&tops[k].start, &tops[k].roots, &tops[k].f);
        for_strip find_positions(&tops[k].f, &tops[k].doubt);
        for_strip place_pole(tops[k].f.q, &tops[k].f.bottom);
        for_strip place_pole(tops[k].f.q, &tops[k].f.top);
        for_strip find_rates(&tops[k].start, &tops[k].roots, &tops[k].f);
        for_strip put_nutation(b, i, &tops[k]);
        if (wants_end || wants_period) for_strip begin_at_turning_point(&tops[k]);
        if ((wants_end || wants_period) && any_of(moves)) {
            for_strip find_start_position(&tops[k]);
            for_strip find_start_argument(&tops[k]);
            for_strip find_thetas(&tops[k], (real){0});
            for_strip find_phases(&tops[k]);
            for_strip keep_start_phases(&tops[k]);
        }
        if (wants_end) {
            for_strip find_thetas(&tops[k], load(b->t_end + i));
            for_strip find_phases(&tops[k]);
            for_strip put_end(b, i, &tops[k]);
            for_strip put_inclination(b, i, &tops[k]);
        }
        if (wants_period) {
            for_strip find_thetas(&tops[k], load(b->t_period + i));
            for_strip find_phases(&tops[k]);
            for_strip put_period(b, i, &tops[k]);
        }
        for_strip memcpy(b->doubt + i, &tops[k].doubt, sizeof tops[k].doubt);
    }
#undef for_strip
}
