// The start of a motion: data as balls, momenta without cancellation, exact zeros, the regime.
#include "balls.h"
#ifdef SPINTOP_FLINT

int ball_sign(const arb_t x) {
    if (arb_is_zero(x) || arb_is_positive(x)) return 1;
    return arb_is_negative(x) ? -1 : 0;
}

static int is_zero(const top_data *data, int which) { return data->value[which] == 0 && data->radius[which] == 0; }

void ball_datum(arb_t x, const top_data *data, int which) {
    arb_set_d(x, data->value[which]);
    if (data->radius[which] > 0) {
        mag_t radius;
        mag_init(radius);
        mag_set_d(radius, data->radius[which]);
        mag_add(arb_radref(x), arb_radref(x), radius);
        mag_clear(radius);
    }
}

// The data; of a body that hangs below its pivot those of the body turned over about its first axis.
static int read_data(top_motion *m, const top_data *data) {
    const slong bits = m->bits;
    int is_known = 1;
    arb_t theta, pi;
    arb_init(theta), arb_init(pi);
    ball_datum(BALL(m, i1), data, INERTIA1), ball_datum(BALL(m, i3), data, INERTIA3);
    ball_datum(BALL(m, weight), data, MASS);
    ball_datum(pi, data, GRAVITY), arb_mul(BALL(m, weight), BALL(m, weight), pi, ARF_PREC_EXACT);
    ball_datum(pi, data, LENGTH), arb_mul(BALL(m, weight), BALL(m, weight), pi, ARF_PREC_EXACT);
    ball_datum(BALL(m, rotor), data, ROTOR);
    m->body_axis = 2;
    if (data->given & GIVEN_OTHERWISE) {
        is_known = ball_given_top(m, data);
    } else {
        is_known = ball_given(m, data);
        ball_datum(BALL(m, phi), data, PHI), ball_datum(BALL(m, psi), data, PSI), ball_datum(theta, data, THETA);
        ball_datum(BALL(m, phi_rate), data, PHI_RATE), ball_datum(BALL(m, theta_rate), data, THETA_RATE);
        ball_datum(BALL(m, spin), data, SPIN);
        arb_cos(BALL(m, u0), theta, bits), arb_sin(BALL(m, s2), theta, bits);
        arb_sqr(BALL(m, s2), BALL(m, s2), bits);
        arb_mul_2exp_si(theta, theta, -1);
        arb_sin_cos(BALL(m, sine), BALL(m, cosine), theta, bits);
        m->pole = is_zero(data, THETA);
    }
    m->is_flipped = (data->value[MASS] * data->value[GRAVITY] < 0) != (data->value[LENGTH] < 0) && data->value[LENGTH] != 0;
    if (m->is_flipped) {
        arb_const_pi(pi, bits);
        arb_add(BALL(m, phi), BALL(m, phi), pi, bits);
        arb_add(BALL(m, psi), BALL(m, psi), pi, bits), arb_neg(BALL(m, psi), BALL(m, psi));
        arb_neg(BALL(m, theta_rate), BALL(m, theta_rate)), arb_neg(BALL(m, spin), BALL(m, spin));
        arb_neg(BALL(m, weight), BALL(m, weight)), arb_neg(BALL(m, u0), BALL(m, u0));
        arb_neg(BALL(m, rotor), BALL(m, rotor));
        arb_swap(BALL(m, sine), BALL(m, cosine));
        m->pole = -m->pole;
    }
    arb_sqr(BALL(m, sh), BALL(m, sine), bits), arb_mul_2exp_si(BALL(m, sh), BALL(m, sh), 1);
    arb_sqr(BALL(m, ch), BALL(m, cosine), bits), arb_mul_2exp_si(BALL(m, ch), BALL(m, ch), 1);
    arb_clear(theta), arb_clear(pi);
    return is_known;
}

// b - a and b + a, exactly zero where the data say so.
static void find_momenta(top_motion *m, int spin_is_omega3) {
    const slong bits = m->bits;
    arb_ptr minus = BALL(m, b_minus_a), plus = BALL(m, b_plus_a);
    if (arb_equal(BALL(m, i1), BALL(m, i3)) && arb_is_exact(BALL(m, i1)) && !spin_is_omega3) {
        arb_t own, turn;
        arb_init(own), arb_init(turn);
        arb_mul(own, BALL(m, i3), BALL(m, spin), ARF_PREC_EXACT), arb_add(own, own, BALL(m, rotor), ARF_PREC_EXACT);
        arb_mul(turn, BALL(m, i1), BALL(m, phi_rate), ARF_PREC_EXACT);
        arb_sub(minus, turn, own, bits), arb_div(minus, minus, BALL(m, i1), bits);
        arb_add(plus, turn, own, bits), arb_div(plus, plus, BALL(m, i1), bits);
        arb_clear(own), arb_clear(turn);
    } else {
        arb_mul(minus, BALL(m, ch), BALL(m, phi_rate), bits), arb_sub(minus, minus, BALL(m, a), bits);
        arb_mul(plus, BALL(m, sh), BALL(m, phi_rate), bits), arb_add(plus, plus, BALL(m, a), bits);
    }
    arb_mul(minus, minus, BALL(m, sh), bits);
    arb_mul(plus, plus, BALL(m, ch), bits);
}

// Whether theta stays as it is, exactly: theta' = 0, and (I1 - I3) phi'^2 u0 + ((I3 psi' + h) phi' - m g l), with omega3
// for psi' and I1 for I1 - I3 where omega3 is given, has no term: cos(theta) of a double that is not 0 is transcendental.
// That of a quaternion is rational.
static int is_steady(const top_motion *m, int spin_is_omega3, int is_rational) {
    int steady;
    arb_t along, rest;
    if (!arb_is_zero(BALL(m, theta_rate))) return 0;
    arb_init(along), arb_init(rest);
    arb_set(along, BALL(m, i1));
    if (!spin_is_omega3) arb_sub(along, along, BALL(m, i3), ARF_PREC_EXACT);
    arb_mul(along, along, BALL(m, phi_rate), ARF_PREC_EXACT);
    arb_mul(rest, BALL(m, i3), BALL(m, spin), ARF_PREC_EXACT), arb_add(rest, rest, BALL(m, rotor), ARF_PREC_EXACT);
    arb_mul(rest, rest, BALL(m, phi_rate), ARF_PREC_EXACT);
    arb_sub(rest, rest, BALL(m, weight), ARF_PREC_EXACT);
    if (is_rational) { // u0 may be rational
        arb_mul(along, along, BALL(m, phi_rate), ARF_PREC_EXACT);
        arb_submul(rest, along, BALL(m, u0), ARF_PREC_EXACT), arb_zero(along);
    }
    steady = arb_is_zero(along) && arb_is_zero(rest);
    arb_clear(along), arb_clear(rest);
    return steady;
}

// The coefficients of the cubic beta y^3 + g2 y^2 + g1 y + g0.
static void find_cubic(top_motion *m) {
    const slong bits = m->bits;
    arb_t term;
    arb_init(term);
    arb_sqr(BALL(m, swing), BALL(m, phi_rate), bits);
    arb_mul(BALL(m, swing), BALL(m, swing), BALL(m, s2), bits);
    arb_sqr(term, BALL(m, theta_rate), bits);
    arb_mul(BALL(m, g0), BALL(m, s2), term, bits);
    arb_add(BALL(m, swing), BALL(m, swing), term, bits);
    arb_mul(term, BALL(m, a), BALL(m, phi_rate), bits), arb_mul_2exp_si(term, term, 1);
    arb_sub(term, term, BALL(m, beta), bits), arb_mul(BALL(m, g1), term, BALL(m, s2), bits);
    arb_mul(term, BALL(m, u0), BALL(m, swing), bits), arb_mul_2exp_si(term, term, 1);
    arb_sub(BALL(m, g1), BALL(m, g1), term, bits);
    arb_mul(BALL(m, g2), BALL(m, beta), BALL(m, u0), bits), arb_mul_2exp_si(BALL(m, g2), BALL(m, g2), 1);
    arb_sub(BALL(m, g2), BALL(m, g2), BALL(m, swing), bits);
    arb_sqr(term, BALL(m, a), bits), arb_sub(BALL(m, g2), BALL(m, g2), term, bits);
    arb_clear(term);
}

int ball_start(top_motion *m, const top_data *data) {
    const slong bits = m->bits;
    int spin_is_omega3 = (data->given & (BY_OMEGA3 | GIVEN_OTHERWISE)) != 0, is_known;
    arb_t term;
    arb_init(term);
    is_known = read_data(m, data);
    arb_set(BALL(m, omega3), BALL(m, spin));
    if (!spin_is_omega3) {
        arb_mul(term, BALL(m, phi_rate), BALL(m, u0), bits);
        arb_add(BALL(m, omega3), BALL(m, omega3), term, bits);
    }
    if (m->pole) { // phi' means nothing but its share of omega3
        arb_zero(BALL(m, phi_rate));
        arb_set(BALL(m, spin), BALL(m, omega3));
        spin_is_omega3 = 1;
    }
    arb_mul(BALL(m, a), BALL(m, i3), BALL(m, omega3), ARF_PREC_EXACT);
    arb_add(BALL(m, a), BALL(m, a), BALL(m, rotor), ARF_PREC_EXACT), arb_div(BALL(m, a), BALL(m, a), BALL(m, i1), bits);
    arb_div(BALL(m, beta), BALL(m, weight), BALL(m, i1), bits), arb_mul_2exp_si(BALL(m, beta), BALL(m, beta), 1);
    arb_sub(BALL(m, half), BALL(m, omega3), BALL(m, a), bits), arb_mul_2exp_si(BALL(m, half), BALL(m, half), -1);
    arb_add(BALL(m, sum), BALL(m, phi), BALL(m, psi), bits), arb_mul_2exp_si(BALL(m, sum), BALL(m, sum), -1);
    arb_sub(BALL(m, difference), BALL(m, phi), BALL(m, psi), bits);
    arb_mul_2exp_si(BALL(m, difference), BALL(m, difference), -1);
    find_momenta(m, spin_is_omega3);
    find_cubic(m);
    m->is_plane = arb_is_zero(BALL(m, b_minus_a)) && arb_is_zero(BALL(m, b_plus_a));
    m->is_turning = m->pole != 0 || arb_is_zero(BALL(m, theta_rate));
    m->regime = arb_is_zero(BALL(m, weight)) ? FREE : NUTATING;
    if (m->pole && arb_is_zero(BALL(m, theta_rate))) {
        m->regime = SLEEPING;
    } else if (!m->pole && is_steady(m, spin_is_omega3, data->given & BY_QUATERNION)) {
        m->regime = STEADY;
        arb_mul(term, BALL(m, phi_rate), BALL(m, u0), bits);
        arb_sub(BALL(m, spin), BALL(m, omega3), term, bits); // psi'
    }
    arb_indeterminate(BALL(m, momentum_period)), arb_indeterminate(BALL(m, momentum_turn));
    if (m->regime == FREE || (m->regime == STEADY && arb_is_zero(BALL(m, weight)))) {
        arb_mul(term, BALL(m, i1), BALL(m, i1), bits), arb_mul(BALL(m, omega), term, BALL(m, swing), bits);
        arb_mul(term, BALL(m, i3), BALL(m, omega3), bits), arb_addmul(BALL(m, omega), term, term, bits);
        arb_sqrt(term, BALL(m, omega), bits);
        if (!arb_is_zero(BALL(m, swing))) ball_circulation(m, BALL(m, i3), BALL(m, i1), BALL(m, omega3), term);
    }
    arb_clear(term);
    return !is_known ? UNDECIDED_BRANCH : arb_contains_zero(BALL(m, i1)) ? UNDECIDED_SIGN : PROVED;
}
#endif
