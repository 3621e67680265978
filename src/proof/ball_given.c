// The start of a motion that is given in any way: quaternion or angles, rates of the angles or angular velocity; for
// a top about body x or y in the axes of which z is its axis. Sums and products of what is exact are exact, so that
// zeros are.
#include "balls.h"
#ifdef SPINTOP_FLINT
#include <math.h>

// The quaternion, not yet divided by its size.
static void read_attitude(arb_ptr q, const top_data *data, slong bits) {
    int i;
    arb_ptr t = _arb_vec_init(3), sum = t, difference = t + 1, half = t + 2;
    if (data->given & BY_QUATERNION) {
        for (i = 0; i < 4; i++) ball_datum(q + i, data, QUATERNION + i);
    } else {
        ball_datum(sum, data, PHI), ball_datum(half, data, PSI);
        arb_sub(difference, sum, half, ARF_PREC_EXACT), arb_add(sum, sum, half, ARF_PREC_EXACT);
        arb_mul_2exp_si(sum, sum, -1), arb_mul_2exp_si(difference, difference, -1);
        arb_sin_cos(q + 3, q, sum, bits), arb_sin_cos(q + 2, q + 1, difference, bits);
        ball_datum(half, data, THETA), arb_mul_2exp_si(half, half, -1);
        arb_sin_cos(sum, difference, half, bits);
        arb_mul(q, q, difference, bits), arb_mul(q + 3, q + 3, difference, bits);
        arb_mul(q + 1, q + 1, sum, bits), arb_mul(q + 2, q + 2, sum, bits);
    }
    _arb_vec_clear(t, 3);
}

// The reciprocal size of a quaternion: 1 if it comes from angles.
static void find_scale(arb_t scale, arb_srcptr q, const top_data *data, slong bits) {
    int i;
    if (data->given & BY_QUATERNION) {
        arb_zero(scale);
        for (i = 0; i < 4; i++) arb_addmul(scale, q + i, q + i, ARF_PREC_EXACT);
        if (!arb_is_one(scale)) arb_rsqrt(scale, scale, bits);
    } else {
        arb_one(scale);
    }
}

// exp(i psi) sin(theta)/2 of a quaternion.
static void find_tilt(acb_t tilt, arb_srcptr q) {
    acb_t lower;
    acb_init(lower);
    acb_set_arb_arb(tilt, q, q + 3), acb_set_arb_arb(lower, q + 1, q + 2), acb_conj(lower, lower);
    acb_mul(tilt, tilt, lower, ARF_PREC_EXACT);
    acb_clear(lower);
}

// sin(psi), cos(psi), sin(theta), cos(theta) at the start, q being a unit quaternion. 0 at a pole where psi is not
// given.
static int find_angles(arb_ptr t, const top_motion *m, const top_data *data) {
    const slong bits = m->bits;
    arb_srcptr q = BALL(m, q0);
    acb_t tilt;
    int is_known;
    if (!(data->given & BY_QUATERNION)) {
        ball_datum(t + 4, data, PSI), arb_sin_cos(t, t + 1, t + 4, bits);
        ball_datum(t + 4, data, THETA), arb_sin_cos(t + 2, t + 3, t + 4, bits);
        return 1;
    }
    acb_init(tilt);
    find_tilt(tilt, q), acb_mul_2exp_si(tilt, tilt, 1), acb_abs(t + 2, tilt, bits);
    is_known = arb_is_positive(t + 2);
    arb_div(t, acb_imagref(tilt), t + 2, bits), arb_div(t + 1, acb_realref(tilt), t + 2, bits);
    arb_sqr(t + 3, q + 1, bits), arb_addmul(t + 3, q + 2, q + 2, bits), arb_mul_2exp_si(t + 3, t + 3, 1);
    arb_sub_ui(t + 3, t + 3, 1, bits), arb_neg(t + 3, t + 3);
    acb_clear(tilt);
    return is_known;
}

// The angular velocity.
static int read_rates(top_motion *m, const top_data *data) {
    int i, is_known = 1;
    arb_ptr omega = BALL(m, omega1), t = _arb_vec_init(8), turn = t + 5, fall = t + 6, term = t + 7;
    if (data->given & BY_OMEGA) {
        for (i = 0; i < 3; i++) ball_datum(omega + i, data, OMEGA1 + i);
    } else {
        ball_datum(turn, data, PHI_RATE), ball_datum(fall, data, THETA_RATE), ball_datum(omega + 2, data, SPIN);
        if (!(arb_is_zero(turn) && arb_is_zero(fall))) {
            is_known = find_angles(t, m, data);
            arb_mul(term, turn, t + 2, ARF_PREC_EXACT), arb_mul(omega, term, t, ARF_PREC_EXACT);
            arb_mul(omega + 1, term, t + 1, ARF_PREC_EXACT);
            arb_addmul(omega, fall, t + 1, ARF_PREC_EXACT), arb_submul(omega + 1, fall, t, ARF_PREC_EXACT);
            if (!(data->given & BY_OMEGA3)) arb_addmul(omega + 2, turn, t + 3, ARF_PREC_EXACT);
        }
    }
    _arb_vec_set(BALL(m, rate1), omega, 3), _arb_vec_clear(t, 8);
    return is_known;
}

int ball_given(top_motion *m, const top_data *data) {
    arb_t scale;
    arb_init(scale);
    read_attitude(BALL(m, q0), data, m->bits), find_scale(scale, BALL(m, q0), data, m->bits);
    if (!arb_is_one(scale)) _arb_vec_scalar_mul(BALL(m, q0), BALL(m, q0), 4, scale, m->bits);
    arb_clear(scale);
    return read_rates(m, data);
}

void ball_quaternion_product(arb_ptr r, arb_srcptr p, arb_srcptr q, slong bits) {
    static const int other[4][4] = {{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 3, 0, 1}, {3, 2, 1, 0}};
    static const int sign[4][4] = {{1, -1, -1, -1}, {1, 1, 1, -1}, {1, -1, 1, 1}, {1, 1, -1, 1}};
    int i, j;
    arb_ptr t = _arb_vec_init(4);
    for (i = 0; i < 4; i++)
        for (j = 0; j < 4; j++) {
            if (sign[i][j] > 0) arb_addmul(t + i, p + j, q + other[i][j], bits);
            else arb_submul(t + i, p + j, q + other[i][j], bits);
        }
    _arb_vec_set(r, t, 4);
    _arb_vec_clear(t, 4);
}

void ball_about_axis(arb_ptr q, int axis, int side) {
    // q (1, s, s, s)/2, s = -1 from body x to z and from z to body y.
    const int s = axis == 0 ? -side : side;
    int i;
    arb_ptr turn = _arb_vec_init(4);
    for (i = 0; i < 4; i++) arb_set_si(turn + i, i == 0 ? 1 : s);
    ball_quaternion_product(q, q, turn, ARF_PREC_EXACT), _arb_vec_scalar_mul_2exp_si(q, q, 4, -1);
    _arb_vec_clear(turn, 4);
}

// The argument of x + i y, next to a number; 0 if it is closer to its opposite, or not known.
static int find_argument(arb_t angle, const arb_t x, const arb_t y, double near, slong bits) {
    acb_t turned, back;
    int is_near;
    acb_init(turned), acb_init(back);
    arb_set_d(angle, -near), arb_sin_cos(acb_imagref(back), acb_realref(back), angle, bits);
    acb_set_arb_arb(turned, x, y), acb_mul(turned, turned, back, bits);
    is_near = arb_is_positive(acb_realref(turned));
    acb_arg(angle, turned, bits);
    arb_set_d(acb_realref(back), near), arb_add(angle, angle, acb_realref(back), bits);
    acb_clear(turned), acb_clear(back);
    return is_near;
}

// phi and psi; those of a motion that starts on a pole are such that it leaves it along theta.
static int read_angles(top_motion *m, arb_ptr q, const top_data *data) {
    const slong bits = m->bits;
    arb_ptr phi = BALL(m, phi), psi = BALL(m, psi), t = _arb_vec_init(2), sum = t, difference = t + 1;
    double near[2] = {(data->value[PHI] + data->value[PSI]) / 2, (data->value[PHI] - data->value[PSI]) / 2}, part[4];
    int i, is_known = 1;
    if (m->body_axis != 2 || m->pole) {
        for (i = 0; i < 4; i++) part[i] = arf_get_d(arb_midref(q + i), ARF_RND_NEAR);
        near[0] = atan2(part[3], part[0]), near[1] = atan2(part[2], part[1]);
    }
    m->is_negated = 0;
    if (m->pole != -1 && !find_argument(sum, q, q + 3, near[0], bits)) m->is_negated = 1;
    if (m->pole != 1 && !find_argument(difference, q + 1, q + 2, near[1], bits)) m->is_negated = 1;
    if (m->is_negated) {
        _arb_vec_neg(q, q, 4);
        if (m->pole != -1) is_known = find_argument(sum, q, q + 3, near[0], bits);
        if (m->pole != 1) is_known = find_argument(difference, q + 1, q + 2, near[1], bits) && is_known;
    }
    if (m->pole) {
        acb_t omega;
        acb_init(omega);
        acb_set_arb_arb(omega, BALL(m, omega1), BALL(m, omega2));
        acb_arg(psi, omega, bits), arb_neg(psi, psi);
        if (m->pole > 0) arb_sub(difference, sum, psi, bits);
        else arb_add(sum, difference, psi, bits);
        acb_clear(omega);
    }
    arb_add(phi, sum, difference, bits), arb_sub(psi, sum, difference, bits);
    _arb_vec_clear(t, 2);
    return is_known;
}

int ball_given_top(top_motion *m, const top_data *data) {
    const slong bits = m->bits;
    int is_known;
    arb_ptr q = _arb_vec_init(6), scale = q + 4, term = q + 5, omega = BALL(m, omega1);
    acb_t tilt, rate;
    acb_init(tilt), acb_init(rate);
    m->body_axis = data->given & AXIS_X ? 0 : data->given & AXIS_Y ? 1 : 2;
    is_known = ball_given(m, data);
    read_attitude(q, data, bits), find_scale(scale, q, data, bits);
    if (m->body_axis != 2) {
        ball_about_axis(q, m->body_axis, -1);
        if (m->body_axis == 0) arb_swap(omega, omega + 1), arb_swap(omega + 1, omega + 2);
        else arb_swap(omega + 1, omega + 2), arb_swap(omega, omega + 1);
    }
    find_tilt(tilt, q);
    if (m->body_axis == 2 && !(data->given & BY_QUATERNION)) {
        ball_datum(term, data, PSI), arb_sin_cos(acb_imagref(tilt), acb_realref(tilt), term, bits);
        ball_datum(term, data, THETA), arb_sin(term, term, bits), arb_mul_2exp_si(term, term, -1);
        acb_mul_arb(tilt, tilt, term, bits);
    }
    m->pole = (arb_is_zero(q + 1) && arb_is_zero(q + 2)) - (arb_is_zero(q) && arb_is_zero(q + 3));
    acb_set_arb_arb(rate, omega, omega + 1);
    if (m->pole) acb_abs(BALL(m, theta_rate), rate, bits);
    acb_mul(rate, rate, tilt, ARF_PREC_EXACT), acb_mul_2exp_si(rate, rate, 1);
    arb_sqr(term, scale, bits), acb_mul_arb(rate, rate, term, bits);
    _arb_vec_scalar_mul(q, q, 4, scale, bits);
    arb_hypot(BALL(m, cosine), q, q + 3, bits), arb_hypot(BALL(m, sine), q + 1, q + 2, bits);
    arb_mul(BALL(m, s2), acb_realref(tilt), acb_realref(tilt), ARF_PREC_EXACT);
    arb_addmul(BALL(m, s2), acb_imagref(tilt), acb_imagref(tilt), ARF_PREC_EXACT);
    arb_sqr(term, scale, bits), arb_sqr(term, term, bits), arb_mul(BALL(m, s2), BALL(m, s2), term, bits);
    arb_mul_2exp_si(BALL(m, s2), BALL(m, s2), 2), arb_sqrt(term, BALL(m, s2), bits);
    arb_zero(BALL(m, phi_rate));
    if (!m->pole) {
        arb_div(BALL(m, theta_rate), acb_realref(rate), term, bits);
        arb_div(BALL(m, phi_rate), acb_imagref(rate), BALL(m, s2), bits);
    }
    arb_mul(BALL(m, u0), q, q, ARF_PREC_EXACT), arb_addmul(BALL(m, u0), q + 3, q + 3, ARF_PREC_EXACT);
    arb_submul(BALL(m, u0), q + 1, q + 1, ARF_PREC_EXACT), arb_submul(BALL(m, u0), q + 2, q + 2, ARF_PREC_EXACT);
    arb_set(BALL(m, spin), omega + 2);
    is_known = read_angles(m, q, data) && is_known;
    _arb_vec_clear(q, 6);
    acb_clear(tilt), acb_clear(rate);
    return is_known;
}
#endif
