// Theta functions of a motion: M+ and M- with their continuous arguments, and logarithmic slopes. In form a the
// phase runs along the real axis, in form b, by the dual nome, along the imaginary one; without gravity the nome is
// 0, and the functions are sines and cosines.
#include "balls.h"
#ifdef SPINTOP_FLINT

// The number of terms of a sum, and a bound of the others: the n-th is at most 2 q^e |w|^k, e = n (n+1) and k = 2 n + 1
// of theta_1 and theta_2, e = n^2 and k = 2 n of the others, with a factor k in the slope. 0 if there is no bound.
static slong count_terms(mag_t rest, const mag_t q, const mag_t size, int is_odd, slong bits) {
    const double log_q = mag_get_d_log2_approx(q), log_size = mag_get_d_log2_approx(size);
    slong n;
    int is_bounded;
    mag_t ratio;
    mag_init(ratio);
    for (n = 2; n < bits; n++)
        if (n * (n + is_odd) * log_q + 2 * n * log_size < -bits - 8 && (2 * n + 1) * log_q + 2 * log_size < -3) break;
    mag_pow_ui(ratio, q, 2 * n + 1), mag_mul(ratio, ratio, size), mag_mul(ratio, ratio, size);
    is_bounded = mag_cmp_2exp_si(ratio, -2) <= 0; // with the factor k at most 1/2
    mag_pow_ui(rest, q, n * (n + is_odd)), mag_pow_ui(ratio, size, 2 * n + is_odd);
    mag_mul(rest, rest, ratio), mag_mul_2exp_si(rest, rest, 2);
    mag_clear(ratio);
    return is_bounded ? n : 0;
}

// theta_which, 1 .. 4, at the phase whose e^(i phase) is w, without the factor q^(1/4) of theta_1 and theta_2; `slope`,
// its derivative, may be NULL.
static void theta(acb_t value, acb_ptr slope, const top_motion *m, int which, const acb_t w, int is_unit) {
    const slong bits = m->bits;
    const int is_odd = which <= 2;
    slong n, terms;
    acb_ptr t = _acb_vec_init(7), up = t, down = t + 1, up2 = t + 2, down2 = t + 3, sum = t + 4, other = t + 5, term = t + 6;
    arb_ptr r = _arb_vec_init(3), factor = r, step = r + 1, square = r + 2;
    mag_t size, rest, q;
    mag_init(size), mag_init(rest), mag_init(q);
    if (is_unit) acb_conj(down, w);
    else acb_inv(down, w, bits);
    acb_set(up, w), acb_get_mag(size, up), acb_get_mag(rest, down), mag_max(size, size, rest);
    arb_get_mag(q, BALL(m, nome));
    terms = count_terms(rest, q, size, is_odd, bits);
    acb_sqr(up2, up, bits);
    if (is_unit) acb_conj(down2, up2);
    else acb_sqr(down2, down, bits);
    arb_sqr(square, BALL(m, nome), bits);
    arb_set(step, is_odd ? square : BALL(m, nome)), arb_one(factor);
    if (!is_odd) acb_one(up), acb_one(down);
    for (n = 0; n < terms && !arb_is_zero(factor); n++) {
        if (n > 0) {
            acb_mul(up, up, up2, bits);
            if (is_unit) acb_conj(down, up);
            else acb_mul(down, down, down2, bits);
        }
        if (which == 1) acb_sub(term, up, down, bits);
        else if (n == 0 && !is_odd) acb_one(term);
        else acb_add(term, up, down, bits);
        acb_mul_arb(term, term, factor, bits), acb_add(sum, sum, term, bits);
        if (slope) {
            if (which == 1) acb_add(term, up, down, bits);
            else acb_sub(term, up, down, bits);
            acb_mul_arb(term, term, factor, bits), acb_mul_ui(term, term, 2 * n + is_odd, bits);
            acb_add(other, other, term, bits);
        }
        arb_mul(factor, factor, step, bits), arb_mul(step, step, square, bits);
        if (which == 1 || which == 4) arb_neg(factor, factor);
    }
    if (!terms) acb_indeterminate(sum), acb_indeterminate(other);
    acb_add_error_mag(sum, rest);
    if (which == 1) acb_div_onei(value, sum);
    else acb_set(value, sum);
    if (slope) {
        mag_mul_ui(rest, rest, 2 * terms + is_odd), acb_add_error_mag(other, rest);
        if (which == 1) acb_set(slope, other);
        else acb_mul_onei(slope, other);
    }
    _acb_vec_clear(t, 7), _arb_vec_clear(r, 3);
    mag_clear(size), mag_clear(rest), mag_clear(q);
}

// e^(i z), z real, as factor along the axis of the phase: the phase of form b is i z, with the sign s.
static void along_axis(acb_t w, const top_motion *m, const arb_t z, int s) {
    if (m->is_dual) {
        if (s > 0) arb_neg(acb_realref(w), z);
        else arb_set(acb_realref(w), z);
        arb_exp(acb_realref(w), acb_realref(w), m->bits), arb_zero(acb_imagref(w));
    } else {
        arb_sin_cos(acb_imagref(w), acb_realref(w), z, m->bits);
    }
}

// The factor of the pole: e^(s nu) in form a, e^(i nu) in form b.
static void across_axis(acb_t w, const top_motion *m, const arb_t nu, int s) {
    if (m->is_dual) {
        arb_sin_cos(acb_imagref(w), acb_realref(w), nu, m->bits);
    } else {
        if (s > 0) arb_set(acb_realref(w), nu);
        else arb_neg(acb_realref(w), nu);
        arb_exp(acb_realref(w), acb_realref(w), m->bits), arb_zero(acb_imagref(w));
    }
}

// (log theta_which)' at w, its real part in form b and its imaginary part in form a.
static void log_slope(arb_t slope, const top_motion *m, int which, const acb_t w, int s) {
    acb_t value, rate;
    acb_init(value), acb_init(rate);
    theta(value, rate, m, which, w, 0), acb_div(value, rate, value, m->bits);
    if (!m->is_dual) arb_set(slope, acb_imagref(value));
    else if (s > 0) arb_set(slope, acb_realref(value));
    else arb_neg(slope, acb_realref(value));
    acb_clear(value), acb_clear(rate);
}

// The nome exp(-pi tau): 0 without gravity, and of a free body on the separatrix.
static void find_nome(top_motion *m) {
    if (arb_is_zero(BALL(m, tau))) {
        arb_zero(BALL(m, nome));
    } else {
        arb_const_pi(BALL(m, nome), m->bits), arb_mul(BALL(m, nome), BALL(m, nome), BALL(m, tau), m->bits);
        arb_neg(BALL(m, nome), BALL(m, nome)), arb_exp(BALL(m, nome), BALL(m, nome), m->bits);
    }
}

// The theta function of a component, and that of the divisor of both.
static int function_of(const top_motion *m, int side) { return side == PLUS ? 1 : m->is_dual ? 4 : 2; }

static int divisor_of(const top_motion *m) { return m->is_dual ? 2 : 4; }

void ball_theta_start(top_motion *m) {
    const slong bits = m->bits;
    acb_t w;
    arb_t half;
    int side;
    acb_init(w), arb_init(half);
    find_nome(m);
    for (side = PLUS; side < SIDES; side++) across_axis(m->w + side, m, BALL(m, nu_plus) + side, m->sense[side]);
    if (m->is_dual) {
        arb_mul_2exp_si(half, BALL(m, height), -1);
        along_axis(w, m, half, m->sense[PLUS]), acb_mul(w, w, m->w + PLUS, bits);
    } else {
        acb_mul_onei(w, m->w + PLUS);
    }
    log_slope(BALL(m, slope_plus), m, function_of(m, PLUS), w, m->sense[PLUS]);
    log_slope(BALL(m, slope_minus), m, function_of(m, MINUS), m->w + MINUS, m->sense[MINUS]);
    acb_clear(w), arb_clear(half);
}

void ball_pole_rate(arb_t rate, const top_motion *m) {
    const slong bits = m->bits;
    const int side = m->pole > 0 ? MINUS : PLUS, sign = m->sense[side];
    acb_t w, value, slope, down;
    acb_init(w), acb_init(value), acb_init(slope), acb_init(down);
    along_axis(w, m, BALL(m, z0), sign), theta(value, slope, m, function_of(m, side), w, !m->is_dual);
    if (m->is_dual) acb_mul_onei(slope, slope), acb_mul_si(slope, slope, sign, bits);
    along_axis(w, m, BALL(m, z0), 1), theta(down, NULL, m, divisor_of(m), w, !m->is_dual);
    acb_div(slope, slope, down, bits);
    // M+ of form b is imaginary there: its real counterpart is its imaginary part, as in ball_attitude.
    arb_mul(rate, m->is_dual && side == PLUS ? acb_imagref(slope) : acb_realref(slope), BALL(m, zeta), bits);
    acb_clear(w), acb_clear(value), acb_clear(slope), acb_clear(down);
}

// The continuous argument of a component near the line `line`, beyond whole jumps. 0 if the component may vanish.
static int argument(arb_t turn, const acb_t value, const arb_t line, const fmpz_t turns, const arb_t jump, slong bits) {
    int is_known;
    acb_t turned;
    arb_t back;
    acb_init(turned), arb_init(back);
    arb_neg(back, line), arb_sin_cos(acb_imagref(turned), acb_realref(turned), back, bits);
    acb_mul(turned, turned, value, bits);
    is_known = acb_is_finite(turned) && !acb_contains_zero(turned);
    if (is_known) {
        acb_arg(turn, turned, bits);
        arb_add(turn, turn, line, bits);
        arb_addmul_fmpz(turn, jump, turns, bits);
    } else {
        arb_indeterminate(turn);
    }
    acb_clear(turned), arb_clear(back);
    return is_known;
}

void ball_components_init(top_components *c) {
    int side;
    for (side = PLUS; side < SIDES; side++) acb_init(c->value + side), arb_init(c->turn + side);
}

void ball_components_clear(top_components *c) {
    int side;
    for (side = PLUS; side < SIDES; side++) acb_clear(c->value + side), arb_clear(c->turn + side);
}

// z reduced by whole half periods, and their number. 0 if there is none.
static int reduce(arb_t z, fmpz_t turns, const top_motion *m, const arb_t phase) {
    arf_t half;
    arb_div(z, phase, BALL(m, height), m->bits);
    if (!arb_is_finite(z)) return 0;
    arf_init(half), arf_set_d(half, 0.5);
    arf_add(arb_midref(z), arb_midref(z), half, m->bits, ARF_RND_DOWN);
    arf_floor(arb_midref(z), arb_midref(z)), arf_get_fmpz(turns, arb_midref(z), ARF_RND_DOWN);
    arb_set(z, phase), arb_submul_fmpz(z, BALL(m, height), turns, m->bits);
    arf_clear(half);
    return 1;
}

int ball_components(top_components *c, const top_motion *m, const arb_t phase) {
    const slong bits = m->bits;
    int is_finite, side;
    arb_ptr t = _arb_vec_init(3), z = t, half = t + 1, line = t + 2;
    acb_t down, w, with_pole;
    fmpz_t turns;
    acb_init(down), acb_init(w), acb_init(with_pole), fmpz_init(turns);
    is_finite = reduce(z, turns, m, phase);
    if (is_finite) along_axis(w, m, z, 1), theta(down, NULL, m, divisor_of(m), w, !m->is_dual);
    for (side = PLUS; side < SIDES && is_finite; side++) {
        acb_ptr value = c->value + side;
        if (m->is_dual) along_axis(w, m, z, m->sense[side]);
        acb_mul(with_pole, w, m->w + side, bits), theta(value, NULL, m, function_of(m, side), with_pole, 0);
        acb_div(value, value, down, bits);
        if (!m->is_dual) {
            arb_const_pi(half, bits), arb_mul_2exp_si(half, half, -1);
            arb_sub(line, z, half, bits), arb_mul_si(line, side == PLUS ? line : z, m->sense[side], bits);
        }
        c->is_known[side] = argument(c->turn + side, value, line, turns, BALL(m, jump_plus) + side, bits);
        c->is_odd = fmpz_is_odd(turns);
    }
    _arb_vec_clear(t, 3);
    acb_clear(down), acb_clear(w), acb_clear(with_pole), fmpz_clear(turns);
    return is_finite;
}

int ball_rises(const top_motion *m, const arb_t time) {
    arb_ptr t = _arb_vec_init(2), z = t, half = t + 1;
    int sign = 0;
    fmpz_t turns;
    fmpz_init(turns);
    arb_mul(half, BALL(m, zeta), time, m->bits), arb_add(half, half, BALL(m, z0), m->bits);
    if (reduce(z, turns, m, half)) sign = arb_is_positive(z) - arb_is_negative(z);
    arb_mul_2exp_si(half, BALL(m, height), -1), arb_abs(z, z);
    if (!arb_lt(z, half)) sign = 0;
    _arb_vec_clear(t, 2), fmpz_clear(turns);
    return sign;
}

void ball_tumbling_start(top_motion *m, const arb_t nu, int side) {
    acb_t w;
    acb_init(w);
    find_nome(m);
    across_axis(w, m, nu, -1), log_slope(BALL(m, slope_plus), m, divisor_of(m), w, 1);
    if (m->is_dual) arb_neg(BALL(m, slope_plus), BALL(m, slope_plus));
    across_axis(m->w + PLUS, m, nu, side);
    if (m->is_dual && side < 0) acb_conj(m->w + PLUS, m->w + PLUS);
    acb_clear(w);
}

void ball_tumbling(acb_t plus, acb_t minus, fmpz_t turns, const top_motion *m, const arb_t phase) {
    const slong bits = m->bits;
    acb_t w;
    arb_t z;
    acb_init(w), arb_init(z);
    fmpz_zero(turns), arb_set(z, phase);
    if (m->is_dual && !arb_is_zero(BALL(m, nome)) && !reduce(z, turns, m, phase)) arb_indeterminate(z);
    along_axis(w, m, z, 1), acb_mul(w, w, m->w + PLUS, bits);
    theta(plus, NULL, m, divisor_of(m), w, 0), theta(minus, NULL, m, 1, w, 0);
    if (m->is_dual) {
        acb_div_onei(minus, minus);
        if (fmpz_is_odd(turns)) acb_neg(minus, minus);
    } else { // theta_4 does not have the factor of theta_1
        arb_root_ui(z, BALL(m, nome), 4, bits), acb_mul_arb(minus, minus, z, bits);
    }
    acb_clear(w), arb_clear(z);
}
#endif
