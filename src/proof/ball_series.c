// The Taylor polynomial of a step, and what bounds its error.
// X_{k+1} is the middle of h f_k/(k+1), rounded to ulps; f_k is a ball, so that the distance from its far side contains the
// errors of sums, of the data and of the u_n alike: `lost`, which bounds the defect of lower orders. That of higher orders
// is what products of X leave over: sums of products of norms.
#include "ball_tube.h"
#ifdef SPINTOP_FLINT
#include <math.h>
#include <string.h>

// A step is as long as errors grow by no more than e^most_growth by the logarithmic norm.
static const double most_growth = 4;
static const double tiny = 1e-300;

// q (0, w): terms (component of q, component of w, sign) of each component. (0, w) q has the signs of the last two changed
// where both are not the scalar's.
static const int product[4][3][3] = {{{1, 0, -1}, {2, 1, -1}, {3, 2, -1}},
                                     {{0, 0, 1}, {2, 2, 1}, {3, 1, -1}},
                                     {{0, 1, 1}, {3, 0, 1}, {1, 2, -1}},
                                     {{0, 2, 1}, {1, 1, 1}, {2, 0, -1}}};

int ball_product(int c, int term, int *a, int *i, int from_left) {
    const int *t = product[c][term];
    *a = t[0], *i = t[1];
    return from_left && *a != 0 && c != 0 ? -t[2] : t[2];
}

double ball_series(const double *c, int count, double s, int first) {
    double sum = 0;
    while (count--) sum = sum * s + c[count];
    while (first--) sum *= s;
    return sum * SAFE;
}

// u_n: 1, t, cosines and sines by their derivatives. `beyond` is what their polynomials lack.
static void expand_waves(ball_step *step, const arb_t time) {
    const ball_field *f = step->field;
    const slong bits = f->bits + 64;
    int n, k;
    double size;
    arb_t angle, h;
    arb_init(angle), arb_init(h), arb_set_si(h, step->sense), arb_mul_2exp_si(h, h, -step->halvings);
    arb_one(WAVE(step, 0)), arb_set(WAVE(step, 1), time), arb_set(WAVE(step, 1) + 1, h), step->beyond = 0;
    for (n = 2; n < WAVES; n += 2) {
        arb_ptr c = WAVE(step, n), s = WAVE(step, n + 1);
        mag_t rest, turn;
        if (!f->has_wave[n] && !f->has_wave[n + 1]) continue;
        mag_init(rest), mag_init(turn);
        arb_mul(angle, f->rate + n / 2 - 1, time, bits), arb_sin_cos(s, c, angle, bits);
        arb_mul(angle, f->rate + n / 2 - 1, h, bits), arb_get_mag(turn, angle), mag_one(rest);
        for (k = 0; k <= f->order; k++) {
            mag_mul(rest, rest, turn), mag_div_ui(rest, rest, (ulong)k + 1);
            if (k == f->order) break;
            arb_mul(c + k + 1, s + k, angle, bits), arb_div_si(c + k + 1, c + k + 1, -(k + 1), bits);
            arb_mul(s + k + 1, c + k, angle, bits), arb_div_si(s + k + 1, s + k + 1, k + 1, bits);
        }
        // Less than twice the next term, as the following ones are at most half of the one before.
        mag_mul_2exp_si(rest, rest, f->bits + 1), size = mag_get_d(rest);
        step->beyond += ball_most(angle) < f->order / 2 ? size * (f->tau[n] + f->tau[n + 1]) : INFINITY;
        mag_clear(rest), mag_clear(turn);
    }
    arb_clear(angle), arb_clear(h);
}

// The next coefficient of a component, from the ball of f_k.
static void settle(arb_t next, arb_t f, int k, const ball_step *step, mag_t lost) {
    const slong bits = step->field->bits;
    mag_t error;
    arb_mul_2exp_si(f, f, -step->halvings), arb_div_si(f, f, step->sense * (k + 1), step->field->bits);
    arf_set_round(arb_midref(next), arb_midref(f), FLINT_MAX(2, bits + arf_abs_bound_lt_2exp_si(arb_midref(f))), ARF_RND_NEAR);
    arb_sub(f, f, next, step->field->bits);
    mag_init(error), arb_get_mag(error, f), mag_add(lost, lost, error), mag_clear(error);
}

// q'_c of order k: half of q w - O q.
static void expand_turn(arb_t rate, const ball_step *step, int c, int k) {
    const ball_field *f = step->field;
    int t, a, i;
    arb_zero(rate);
    for (t = 0; t < 3; t++) {
        const int is_minus = ball_product(c, t, &a, &i, 0) < 0;
        arb_dot(rate, rate, is_minus, SERIES(step, a), 1, SERIES(step, 4 + i) + k, -1, k + 1, f->bits);
    }
    for (t = 0; t < 3 && f->frame > 0; t++) {
        if (ball_product(c, t, &a, &i, 1) < 0) arb_addmul(rate, SERIES(step, a) + k, f->turn + i, f->bits);
        else arb_submul(rate, SERIES(step, a) + k, f->turn + i, f->bits);
    }
    arb_mul_2exp_si(rate, rate, -1);
}

// The coefficients of X and their doubles.
static void expand_state(ball_step *step, arb_srcptr state) {
    const ball_field *f = step->field;
    const int n = f->order + 1;
    int c, i, k, p, wave;
    arb_ptr rate = _arb_vec_init(STATES + PAIRS), pair = rate + STATES, torque = _arb_vec_init(WAVES * 3 * n);
    mag_t lost;
    mag_init(lost);
    for (c = 0; c < STATES; c++) arb_set(SERIES(step, c), state + c);
    for (k = 0; k < f->order; k++) {
        for (p = 0; p < PAIRS; p++)
            if (f->has_pair[p])
                arb_dot(pair + p, NULL, 0, SERIES(step, ball_pair[p][0]), 1, SERIES(step, ball_pair[p][1]) + k, -1, k + 1,
                        f->bits);
        for (c = 0; c < 4; c++) expand_turn(rate + c, step, c, k);
        for (i = 0; i < 3; i++) {
            arb_ptr total = rate + 4 + i;
            arb_dot(total, NULL, 0, SERIES(step, 4 + (i + 1) % 3), 1, SERIES(step, 4 + (i + 2) % 3) + k, -1, k + 1, f->bits);
            arb_mul(total, total, f->coupling + i, f->bits);
            for (wave = 0; wave < WAVES; wave++) {
                arb_ptr t = torque + (wave * 3 + i) * n;
                const int row = wave * 3 + i, length = wave < 2 ? wave + 1 : n;
                if (!f->has_wave[wave]) continue;
                arb_dot(t + k, NULL, 0, f->form + row * PAIRS, 1, pair, 1, PAIRS, f->bits);
                arb_dot(t + k, t + k, 0, f->gyro + row * 3, 1, SERIES(step, 4) + k, n, 3, f->bits);
                arb_dot(total, total, 0, WAVE(step, wave), 1, t + k, -1, FLINT_MIN(length, k + 1), f->bits);
            }
        }
        for (c = 0; c < STATES; c++) settle(SERIES(step, c) + k + 1, rate + c, k, step, lost);
    }
    mag_mul_2exp_si(lost, lost, f->bits), step->lost = mag_get_d(lost) * SAFE;
    for (i = 0; i < STATES * n; i++) step->real[i] = arf_get_d(arb_midref(step->x + i), ARF_RND_NEAR);
    for (i = 0; i < WAVES * n; i++) step->u[i] = arf_get_d(arb_midref(step->wave + i), ARF_RND_NEAR);
    mag_clear(lost), _arb_vec_clear(rate, STATES + PAIRS), _arb_vec_clear(torque, WAVES * 3 * n);
}

// Adds factor a * b, a product of series of n terms and of m.
static void convolve(double *sum, double factor, const double *a, int n, const double *b, int m) {
    int i, j;
    for (i = 0; i < n; i++) {
        const double x = factor * a[i];
        for (j = 0; x > 0 && j < m; j++) sum[i + j] += x * b[j];
    }
}

// Norms by orders. With a = |q|, b = |w|, A = F * a:
//     growth    h (1.42 kappa b + L + a/4 + A), F and L being sum |T_n| |u_n| and sum |H_n| |u_n|
//     |h J|     h (b + 0.87 a + 2 A + 1.42 kappa b + L + |O|)
//     tail      h (a*b/2 + kappa b*b + A*a + L*b + |O| a/2), beyond the order
static void find_norms(ball_step *step) {
    const ball_field *f = step->field;
    const int n = f->order + 1;
    const double h = ldexp(1, -(int)step->halvings);
    double *torque = flint_calloc((size_t)(4 * n), sizeof(double)), *gyro = torque + n, *force = gyro + n, *tail = step->tail;
    int c, k, wave;
    for (k = 0; k < n; k++) {
        double q = 0, w = 0;
        for (c = 0; c < 4; c++) q += pow(step->real[c * n + k], 2);
        for (; c < STATES; c++) w += pow(step->real[c * n + k], 2);
        step->a[k] = sqrt(q) * SAFE + tiny, step->b[k] = sqrt(w) * SAFE + tiny;
        for (wave = 0; wave < WAVES; wave++) {
            torque[k] += f->tau[wave] * fabs(step->u[wave * n + k]) * SAFE;
            gyro[k] += f->eta[wave] * fabs(step->u[wave * n + k]) * SAFE;
        }
    }
    memset(tail, 0, (size_t)(3 * n) * sizeof(double));
    convolve(force, 1, torque, n, step->a, n);
    for (k = 0; k < 2 * n; k++) {
        double own = 2 * force[k], common = k < n ? 1.42 * f->kappa * step->b[k] + gyro[k] : 0;
        if (k < n) own += step->b[k] + 0.87 * step->a[k];
        if (k == 0) own += f->frame;
        step->jacobian[k] = h * (own + common) * SAFE;
        step->growth[k] = h * (common + force[k] + (k < n ? step->a[k] / 4 : 0)) / (k + 1) * SAFE;
    }
    convolve(tail, 0.5, step->a, n, step->b, n), convolve(tail, f->kappa, step->b, n, step->b, n);
    convolve(tail, 1, force, 2 * n - 1, step->a, n), convolve(tail, 1, gyro, n, step->b, n);
    tail[f->order] += f->frame * step->a[f->order] / 2;
    for (k = f->order; k < 3 * n; k++) tail[k] *= ldexp(h, (int)f->bits) / (k + 1) * SAFE;
    for (step->bend = 0.25 + f->kappa, wave = 0; wave < WAVES; wave++) step->bend += f->tau[wave];
    step->bend *= h * SAFE;
    flint_free(torque);
}

void ball_expand(ball_step *step, arb_srcptr state, const arb_t time) {
    expand_waves(step, time), expand_state(step, state), find_norms(step);
}

// Whether up to s the defect beyond the order is as small as rounding, and errors grow little.
static int fits(const ball_step *step, double s) {
    const int n = step->field->order;
    return ball_series(step->tail + n, 2 * n + 1, s, n + 1) <= n && ball_series(step->growth, 2 * n + 1, s, 1) < most_growth
           && step->beyond <= n;
}

int ball_longest(const ball_step *step) {
    int far = 64;
    if (fits(step, 2)) return 128;
    while (far > 0 && !fits(step, far / 64.0)) far--;
    return far;
}
#endif
