// The attitude of a motion at a time, and its periods.
#include "balls.h"
#ifdef SPINTOP_FLINT

// size e^(i phase).
static void polar(acb_t value, const arb_t size, const arb_t phase, slong bits) {
    arb_sin_cos(acb_imagref(value), acb_realref(value), phase, bits);
    acb_mul_arb(value, value, size, bits);
}

// The part of M+ or M- that does not vanish identically where it is real or imaginary, with the sign of its turns.
static void real_part(arb_t part, const top_components *c, int side, int is_dual) {
    acb_srcptr value = c->value + side;
    arb_set(part, side == PLUS && is_dual ? acb_imagref(value) : acb_realref(value));
    if (c->is_odd) arb_neg(part, part);
}

// One component, q0 + i q3 or q1 + i q2, and its phase, of which `phase` is that at the start.
static int component(acb_t value, arb_t phase, const top_motion *m, const top_components *now, int side, const arb_t time) {
    const top_components *first = &m->first;
    const slong bits = m->bits;
    const int starts_here = m->pole == (side == PLUS ? -1 : 1);
    int is_known = 1;
    arb_srcptr size = BALL(m, cosine) + side;
    arb_t factor, other;
    arb_init(factor), arb_init(other);
    if (!m->is_plane) arb_addmul(phase, BALL(m, kappa_plus) + side, time, bits);
    else if (side == PLUS) arb_addmul(phase, BALL(m, half), time, bits);
    else arb_submul(phase, BALL(m, half), time, bits);
    if (starts_here) {
        real_part(factor, now, side, m->is_dual);
        arb_div(factor, factor, BALL(m, start_rate), bits), arb_mul(factor, factor, BALL(m, theta_rate), bits);
        arb_mul_2exp_si(factor, factor, -1);
        if (side == PLUS) arb_neg(factor, factor);
    } else if (m->is_plane && (side == PLUS || m->meets_top)) {
        real_part(factor, now, side, m->is_dual), real_part(other, first, side, m->is_dual);
        arb_div(factor, factor, other, bits), arb_mul(factor, factor, size, bits);
    } else {
        acb_abs(factor, now->value + side, bits), acb_abs(other, first->value + side, bits);
        arb_div(factor, factor, other, bits), arb_mul(factor, factor, size, bits);
        if (!m->is_plane) {
            is_known = now->is_known[side] && first->is_known[side];
            arb_add(phase, phase, now->turn + side, bits), arb_sub(phase, phase, first->turn + side, bits);
        }
    }
    polar(value, factor, phase, bits);
    arb_clear(factor), arb_clear(other);
    return is_known;
}

// Both components and their phases while theta varies.
static int nutating(acb_t upper, acb_t lower, arb_t plus, arb_t minus, const top_motion *m, const arb_t time) {
    const slong bits = m->bits;
    top_components now;
    arb_t z;
    int is_known;
    ball_components_init(&now), arb_init(z);
    arb_mul(z, BALL(m, zeta), time, bits), arb_add(z, z, BALL(m, z0), bits);
    is_known = ball_components(&now, m, z);
    if (is_known) {
        is_known = component(upper, plus, m, &now, PLUS, time);
        is_known = component(lower, minus, m, &now, MINUS, time) && is_known;
    }
    ball_components_clear(&now), arb_clear(z);
    return is_known;
}

// Both components and their phases while theta is constant.
static void resting(acb_t upper, acb_t lower, arb_t plus, arb_t minus, const top_motion *m, const arb_t time) {
    const slong bits = m->bits;
    arb_t rate;
    arb_init(rate);
    if (m->regime == STEADY) {
        arb_add(rate, BALL(m, phi_rate), BALL(m, spin), bits), arb_mul_2exp_si(rate, rate, -1);
        arb_addmul(plus, rate, time, bits);
        arb_sub(rate, BALL(m, phi_rate), BALL(m, spin), bits), arb_mul_2exp_si(rate, rate, -1);
        arb_addmul(minus, rate, time, bits);
    } else {
        arb_mul_2exp_si(rate, BALL(m, omega3), -1);
        arb_addmul(plus, rate, time, bits), arb_submul(minus, rate, time, bits);
    }
    polar(upper, BALL(m, cosine), plus, bits), polar(lower, BALL(m, sine), minus, bits);
    arb_clear(rate);
}

// The answer in the axes in which the body was given.
static void turn_back(arb_ptr answer, slong bits) {
    arb_t pi;
    arb_init(pi), arb_const_pi(pi, bits);
    arb_swap(answer + Q0, answer + Q1), arb_neg(answer + Q0, answer + Q0);
    arb_swap(answer + Q2, answer + Q3), arb_neg(answer + Q3, answer + Q3);
    arb_sub(answer + ANGLE_PHI, answer + ANGLE_PHI, pi, bits);
    arb_add(answer + ANGLE_PSI, answer + ANGLE_PSI, pi, bits), arb_neg(answer + ANGLE_PSI, answer + ANGLE_PSI);
    arb_clear(pi);
}

// phi and psi of a quaternion, but for whole turns; NaN on a pole.
static void angles_of(arb_ptr answer, slong bits) {
    static const int which[2] = {ANGLE_PHI, ANGLE_PSI};
    int i;
    acb_t upper, lower, product;
    arb_t pi;
    acb_init(upper), acb_init(lower), acb_init(product), arb_init(pi);
    acb_set_arb_arb(upper, answer + Q0, answer + Q3), acb_set_arb_arb(lower, answer + Q1, answer + Q2);
    for (i = 0; i < 2; i++, acb_conj(lower, lower)) {
        arb_ptr angle = answer + which[i];
        acb_mul(product, upper, lower, bits);
        if (acb_contains_zero(product)) {
            arb_indeterminate(angle);
        } else if (arb_contains_negative(acb_realref(product))) { // away from the cut
            acb_neg(product, product), acb_arg(angle, product, bits);
            arb_const_pi(pi, bits), arb_add(angle, angle, pi, bits);
        } else {
            acb_arg(angle, product, bits);
        }
    }
    acb_clear(upper), acb_clear(lower), acb_clear(product), arb_clear(pi);
}

int ball_has_turns(const top_motion *m) { return m->regime >= ROTATING || m->body_axis != 2; }

int ball_knows_turns(const top_motion *m) { return !ball_has_turns(m) && !m->meets_pole; }

int ball_attitude(arb_ptr answer, const top_motion *m, double t) {
    const slong bits = m->bits;
    int reason = PROVED;
    acb_t upper, lower;
    arb_ptr w = _arb_vec_init(5), time = w, plus = w + 1, minus = w + 2, high = w + 3, low = w + 4;
    acb_init(upper), acb_init(lower);
    arb_set_d(time, t), arb_set(plus, BALL(m, sum)), arb_set(minus, BALL(m, difference));
    if (m->regime == STEPPING) reason = ball_tube_attitude(upper, lower, m, t);
    else if (m->regime >= ROTATING) ball_free_attitude(upper, lower, m, time);
    else if (m->regime == STEADY || m->regime == SLEEPING) resting(upper, lower, plus, minus, m, time);
    else if (!nutating(upper, lower, plus, minus, m, time)) reason = UNDECIDED_BRANCH;
    arb_set(answer + Q0, acb_realref(upper)), arb_set(answer + Q3, acb_imagref(upper));
    arb_set(answer + Q1, acb_realref(lower)), arb_set(answer + Q2, acb_imagref(lower));
    arb_add(answer + ANGLE_PHI, plus, minus, bits), arb_sub(answer + ANGLE_PSI, plus, minus, bits);
    if (m->is_flipped) turn_back(answer, bits);
    if (m->is_negated) _arb_vec_neg(answer + Q0, answer + Q0, 4);
    if (m->body_axis != 2 && m->regime < ROTATING) ball_about_axis(answer + Q0, m->body_axis, 1);
    arb_hypot(high, answer + Q0, answer + Q3, bits), arb_hypot(low, answer + Q1, answer + Q2, bits);
    arb_atan2(answer + ANGLE_THETA, low, high, bits), arb_mul_2exp_si(answer + ANGLE_THETA, answer + ANGLE_THETA, 1);
    if (!ball_knows_turns(m)) angles_of(answer, bits);
    acb_clear(upper), acb_clear(lower);
    _arb_vec_clear(w, 5);
    return reason;
}

void ball_periods(arb_ptr answer, const top_motion *m) {
    const slong bits = m->bits;
    arb_ptr period = answer + PERIOD, turn = answer + PRECESSION;
    arb_t pi;
    arb_init(pi), arb_const_pi(pi, bits);
    arb_set(answer + MOMENTUM_PERIOD, BALL(m, momentum_period)), arb_set(answer + MOMENTUM_TURN, BALL(m, momentum_turn));
    if (m->regime == STEPPING) {
        arb_indeterminate(period), arb_indeterminate(turn);
    } else if (m->regime >= ROTATING) { // the axis of a symmetric body goes round the momentum; of others nothing is known
        arb_set(period, BALL(m, period));
        arb_add(turn, BALL(m, jump_plus), BALL(m, jump_minus), bits);
    } else if (m->regime == STEADY || m->regime == SLEEPING) { // of infinitely small nutations, where they oscillate
        arb_neg(period, BALL(m, g2));
        if (arb_is_positive(period)) {
            arb_rsqrt(period, period, bits), arb_mul(period, period, pi, bits), arb_mul_2exp_si(period, period, 1);
        } else {
            arb_indeterminate(period);
        }
        if (m->regime == SLEEPING) arb_zero(turn);
        else arb_mul(turn, BALL(m, phi_rate), period, bits);
    } else {
        arb_set(period, BALL(m, period));
        arb_add(turn, BALL(m, slope_plus), BALL(m, slope_minus), bits), arb_mul(turn, turn, period, bits);
        arb_add(turn, turn, BALL(m, jump_plus), bits), arb_add(turn, turn, BALL(m, jump_minus), bits);
        if (m->meets_top) arb_sub(turn, turn, pi, bits);
        if (m->meets_bottom) arb_sub(turn, turn, pi, bits);
        if (m->is_plane) arb_zero(turn);
    }
    if (m->regime < ROTATING && m->body_axis != 2) { // those of another axis than body z
        arb_indeterminate(period), arb_indeterminate(turn);
    }
    arb_clear(pi);
}
#endif
