// Periods and phases of a motion between its turning points: Carlson's R_F, and logarithmic slopes of theta functions.
#include "balls.h"
#ifdef SPINTOP_FLINT

// Carlson's R_F of numbers that are not negative; NaN where a ball does not say so.
void ball_carlson(arb_t value, const arb_t x, const arb_t y, const arb_t z, slong bits) {
    acb_t a, b, c, f;
    if (!(arb_is_nonnegative(x) && arb_is_nonnegative(y) && arb_is_nonnegative(z))) {
        arb_indeterminate(value);
        return;
    }
    acb_init(a), acb_init(b), acb_init(c), acb_init(f);
    acb_set_arb(a, x), acb_set_arb(b, y), acb_set_arb(c, z);
    acb_elliptic_rf(f, a, b, c, 0, bits);
    arb_set(value, acb_realref(f));
    acb_clear(a), acb_clear(b), acb_clear(c), acb_clear(f);
}

// The complete integral K of a complementary modulus squared.
void ball_complete(arb_t k, const arb_t complement, slong bits) {
    arb_t one;
    arb_init(one), arb_one(one);
    arb_sqrt(k, complement, bits), arb_agm(k, one, k, bits);
    arb_const_pi(one, bits), arb_mul_2exp_si(one, one, -1), arb_div(k, one, k, bits);
    arb_clear(one);
}

// The distances between roots and poles. Without gravity y3 is infinite: then their ratios have limits.
enum { D, E, UP, M1, P2, BELOW, ABOVE, P1, K2, K2_DUAL, ABOVE_BY_E, UP_BY_E, TERM, OTHER, V, DISTANCES };

static void find_distances(arb_ptr t, const top_motion *m) {
    const slong bits = m->bits;
    arb_sub(t + D, BALL(m, y2), BALL(m, y1), bits);
    arb_sub(t + M1, BALL(m, sh), BALL(m, y1), bits), arb_add(t + P2, BALL(m, ch), BALL(m, y2), bits);
    arb_sub(t + BELOW, BALL(m, sh), BALL(m, y2), bits);
    if (m->meets_top) arb_zero(t + BELOW);
    arb_sqr(t + P1, BALL(m, b_plus_a), bits), arb_div(t + P1, t + P1, t + P2, bits);
    if (m->regime == FREE) {
        arb_neg(t + TERM, BALL(m, g2)), arb_div(t + P1, t + P1, t + TERM, bits);
        arb_zero(t + K2), arb_one(t + K2_DUAL), arb_one(t + ABOVE_BY_E), arb_one(t + UP_BY_E);
        return;
    }
    arb_sub(t + E, BALL(m, y3), BALL(m, y2), bits), arb_sub(t + UP, BALL(m, y3), BALL(m, y1), bits);
    arb_add(t + TERM, BALL(m, ch), BALL(m, y3), bits), arb_mul(t + TERM, t + TERM, BALL(m, beta), bits);
    arb_div(t + P1, t + P1, t + TERM, bits);
    if (m->meets_top) {
        arb_sub(t + ABOVE, BALL(m, y3), BALL(m, sh), bits);
    } else if (arb_is_zero(BALL(m, b_minus_a))) {
        arb_zero(t + ABOVE);
    } else {
        arb_mul(t + TERM, t + M1, t + BELOW, bits), arb_mul(t + TERM, t + TERM, BALL(m, beta), bits);
        arb_sqr(t + ABOVE, BALL(m, b_minus_a), bits), arb_div(t + ABOVE, t + ABOVE, t + TERM, bits);
    }
    arb_div(t + K2, t + D, t + UP, bits), arb_div(t + K2_DUAL, t + E, t + UP, bits);
    arb_div(t + ABOVE_BY_E, t + ABOVE, t + E, bits), arb_div(t + UP_BY_E, t + UP, t + E, bits);
}

// Phases of the poles, v+ and v-, and of the start, all still to be multiplied by c.
static void find_phases(top_motion *m, arb_ptr t, const arb_t quarter) {
    const slong bits = m->bits;
    arb_ptr v = t + V, term = t + TERM, other = t + OTHER;
    arb_mul(term, t + K2, t + P1, bits), arb_add(term, term, t + D, bits);
    ball_carlson(v, t + D, term, t + P2, bits);
    arb_sqrt(term, t + P1, bits), arb_mul(BALL(m, nu_plus), v, term, bits);
    arb_div(term, t + D, t + M1, bits), arb_mul(other, term, t + ABOVE_BY_E, bits);
    arb_one(v), ball_carlson(v, other, term, v, bits);
    arb_div(term, t + BELOW, t + M1, bits), arb_mul(term, term, t + UP_BY_E, bits);
    arb_sqrt(term, term, bits), arb_mul(BALL(m, nu_minus), v, term, bits);
    if (m->is_turning) {
        if (m->starts_high) arb_set(BALL(m, z0), quarter);
        else arb_zero(BALL(m, z0));
        return;
    }
    arb_div(term, BALL(m, y1), t + D, bits), arb_mul(other, t + K2, term, bits);
    arb_add_ui(other, other, 1, bits);
    arb_neg(term, term), arb_sqrt(BALL(m, z0), term, bits);
    arb_div(term, BALL(m, y2), t + D, bits), arb_one(v), ball_carlson(v, term, other, v, bits);
    arb_mul(BALL(m, z0), BALL(m, z0), v, bits);
    if (arb_is_positive(BALL(m, theta_rate))) arb_neg(BALL(m, z0), BALL(m, z0));
}

// What follows from the phases: steps per nutation, and the rates kappa+ and kappa-.
static void find_rates(top_motion *m, arb_ptr t) {
    const slong bits = m->bits;
    arb_ptr term = t + TERM;
    int side;
    ball_theta_start(m);
    for (side = PLUS; side < SIDES; side++) {
        arb_ptr jump = BALL(m, jump_plus) + side, slope = BALL(m, slope_plus) + side;
        arb_const_pi(jump, bits), arb_mul_2exp_si(term, BALL(m, nu_plus) + side, 1);
        if (m->is_dual) arb_sub(jump, jump, term, bits);
        arb_mul_si(jump, jump, m->sense[side], bits), arb_mul(slope, slope, BALL(m, zeta), bits);
        arb_div(term, BALL(m, b_plus_a) + side, t + (side == PLUS ? P2 : M1), bits), arb_mul_2exp_si(term, term, -1);
        arb_sub(slope, term, slope, bits);
    }
    if (m->meets_top) arb_zero(BALL(m, slope_minus));
    if (m->meets_bottom) arb_zero(BALL(m, slope_plus));
    arb_add(BALL(m, kappa_plus), BALL(m, slope_plus), BALL(m, half), bits);
    arb_sub(BALL(m, kappa_minus), BALL(m, slope_minus), BALL(m, half), bits);
}

int ball_phases(top_motion *m) {
    const slong bits = m->bits;
    int reason;
    arb_t quarter, dual, c;
    arb_ptr t = _arb_vec_init(DISTANCES);
    arb_init(quarter), arb_init(dual), arb_init(c);
    m->sense[PLUS] = ball_sign(BALL(m, b_plus_a)), m->sense[MINUS] = ball_sign(BALL(m, b_minus_a));
    find_distances(t, m);
    m->is_dual = arf_cmp_d(arb_midref(t + K2), 0.5) > 0;
    arb_const_pi(c, bits);
    if (m->regime == FREE) {
        arb_mul_2exp_si(quarter, c, -1);
        arb_neg(BALL(m, omega), BALL(m, g2));
    } else {
        ball_complete(quarter, t + K2_DUAL, bits), ball_complete(dual, t + K2, bits);
        arb_mul(BALL(m, omega), BALL(m, beta), t + UP, bits);
    }
    arb_sqrt(BALL(m, omega), BALL(m, omega), bits), arb_mul_2exp_si(BALL(m, omega), BALL(m, omega), -1);
    arb_div(BALL(m, period), quarter, BALL(m, omega), bits);
    arb_mul_2exp_si(BALL(m, period), BALL(m, period), 1);
    find_phases(m, t, quarter);
    arb_set(BALL(m, height), c);
    if (m->is_dual) {
        arb_mul(BALL(m, height), c, quarter, bits), arb_div(BALL(m, height), BALL(m, height), dual, bits);
        arb_swap(quarter, dual);
    }
    arb_div(BALL(m, tau), dual, quarter, bits);
    arb_div(c, c, quarter, bits), arb_mul_2exp_si(c, c, -1);
    arb_mul(BALL(m, zeta), c, BALL(m, omega), bits);
    arb_mul(BALL(m, nu_plus), BALL(m, nu_plus), c, bits), arb_mul(BALL(m, nu_minus), BALL(m, nu_minus), c, bits);
    arb_mul(BALL(m, z0), BALL(m, z0), c, bits);
    if (m->meets_bottom) arb_zero(BALL(m, nu_plus));
    reason = m->sense[PLUS] && m->sense[MINUS] ? PROVED : UNDECIDED_SIGN;
    if (!(arb_is_finite(BALL(m, nu_plus)) && arb_is_finite(BALL(m, nu_minus)) && arb_is_finite(BALL(m, z0))))
        reason = UNDECIDED_BRANCH;
    if (reason == PROVED) {
        find_rates(m, t);
        if (m->pole) ball_pole_rate(BALL(m, start_rate), m);
        if (!ball_components(&m->first, m, BALL(m, z0))) reason = UNDECIDED_BRANCH;
    }
    _arb_vec_clear(t, DISTANCES);
    arb_clear(quarter), arb_clear(dual), arb_clear(c);
    return reason;
}
#endif
