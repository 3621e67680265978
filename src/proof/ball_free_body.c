// The motion of a free body: no moment of weight about its pivot, any moments of inertia, any start. Its momentum
// circulates about body axis z of the axes x, y, z; in units of its size it is (s a cn, b sn, c dn), but for signs.
// Relative to it the attitude is exp(i kappa t) (F+, F-)/size, two theta functions of one argument, so that there is
// no branch to choose. Form b, close to the separatrix, runs by the dual nome.
#include "balls.h"
#ifdef SPINTOP_FLINT

// q times the rotation by a constant angular velocity, 2 half for a second.
static void rotate(arb_ptr q, arb_srcptr half, const arb_t time, slong bits) {
    arb_ptr t = _arb_vec_init(6), turn = t, size = t + 4, angle = t + 5;
    int i;
    for (i = 0; i < 3; i++) arb_addmul(size, half + i, half + i, bits);
    if (!arb_is_zero(size)) {
        arb_sqrt(size, size, bits), arb_mul(angle, size, time, bits);
        arb_sin_cos(angle, turn, angle, bits), arb_div(angle, angle, size, bits);
        for (i = 0; i < 3; i++) arb_mul(turn + 1 + i, half + i, angle, bits);
        ball_quaternion_product(q, q, turn, bits);
    }
    _arb_vec_clear(t, 6);
}

// Whether two moments of inertia are the same number: those with radii remain equal.
static int are_same(const top_data *data, int i, int j) {
    static const int place[3] = {INERTIA1, INERTIA2, INERTIA3};
    return data->value[place[i]] == data->value[place[j]] && data->radius[place[i]] == data->radius[place[j]];
}

// The body axes in the order of their moments, which are different; whether that is known.
static int sort_axes(top_motion *m) {
    int i, kept;
    for (i = 0; i < 3; i++) m->axis[i] = i;
    for (i = 0; i < 3; i++) {
        int *first = m->axis + i % 2;
        arb_srcptr low = BALL(m, i1) + first[0], high = BALL(m, i1) + first[1];
        if (arb_lt(low, high)) continue;
        if (!arb_gt(low, high)) return 0;
        kept = first[0], first[0] = first[1], first[1] = kept;
    }
    return 1;
}

// What the constants of a tumbling body are made of: moments and momenta about x, y, z, the excess I3 (I3-I2) w3^2
// - I1 (I2-I1) w1^2 of the smallest and largest moment, the size G of the momentum, parts of it.
// clang-format off
enum { IX, IY, IZ, LX, LY, LZ, EXCESS, G, A, B, C, R_YZ, R_XY, K_DUAL, LANDEN, RATIO, RATE, SPEED, POLE, START, K_OF_K,
       K_OF_DUAL, TERM, OTHER, CONSTANTS };
// clang-format on

// The class of the motion: axes, signs, momenta in the axes x, y, z.
static int find_class(top_motion *m, arb_ptr t) {
    static const int ends[2] = {2, 0};
    int i, side, is_odd;
    arb_ptr term = t + TERM, other = t + OTHER;
    if (!sort_axes(m)) return UNDECIDED_ROOTS;
    for (i = 0; i < 2; i++) {
        arb_srcptr inertia = BALL(m, i1) + m->axis[ends[i]], omega = BALL(m, omega1) + m->axis[ends[i]];
        arb_sub(term, inertia, BALL(m, i1) + m->axis[1], ARF_PREC_EXACT);
        arb_mul(term, term, inertia, ARF_PREC_EXACT), arb_mul(other, omega, omega, ARF_PREC_EXACT);
        arb_mul(term, term, other, ARF_PREC_EXACT), arb_add(t + EXCESS, t + EXCESS, term, ARF_PREC_EXACT);
    }
    side = ball_sign(t + EXCESS);
    if (!side) return UNDECIDED_ROOTS;
    if (side < 0) i = m->axis[0], m->axis[0] = m->axis[2], m->axis[2] = i, arb_neg(t + EXCESS, t + EXCESS);
    is_odd = (m->axis[1] + 3 - m->axis[0]) % 3 != 1;
    for (i = 0; i < 3; i++) {
        arb_set(t + IX + i, BALL(m, i1) + m->axis[i]);
        arb_mul(t + LX + i, t + IX + i, BALL(m, omega1) + m->axis[i], m->bits);
    }
    m->sign[0] = side * ball_sign(t + LX), m->sign[2] = ball_sign(t + LZ);
    m->sign[1] = m->sign[0] * m->sign[2] * (is_odd ? -1 : 1);
    for (i = 0; i < 3; i++) arb_addmul(t + G, t + LX + i, t + LX + i, m->bits);
    arb_sqrt(t + G, t + G, m->bits);
    for (i = 0; i < 3; i++) arb_div(t + LX + i, t + LX + i, t + G, m->bits);
    arb_mul_si(t + LY, t + LY, m->sign[1], m->bits), arb_abs(t + LX, t + LX), arb_abs(t + LZ, t + LZ);
    m->is_turning = side < 0; // about the axis of the smallest moment: s = -1
    return m->sign[0] && m->sign[2] ? PROVED : UNDECIDED_SIGN;
}

// |Ii - Ij| Ik/(|Ix - Iz| Iy), a ratio of differences of reciprocals.
static void find_ratio(arb_t ratio, arb_ptr t, int i, int j, int k, slong bits) {
    arb_sub(ratio, t + i, t + j, bits), arb_sub(t + TERM, t + IX, t + IZ, bits), arb_div(ratio, ratio, t + TERM, bits);
    arb_mul(ratio, ratio, t + k, bits), arb_div(ratio, ratio, t + IY, bits), arb_abs(ratio, ratio);
}

// sqrt(x^2 + y^2 r).
static void find_part(arb_t part, const arb_t x, const arb_t y, const arb_t r, slong bits) {
    arb_t term;
    arb_init(term);
    arb_sqr(part, y, bits), arb_mul(part, part, r, bits), arb_sqr(term, x, bits), arb_add(part, part, term, bits);
    arb_sqrt(part, part, bits);
    arb_clear(term);
}

// a, b, c, k', the Landen modulus (1-k')/(1+k'), r = a/(1+c), the rate Om of the elliptic functions, rho.
static void find_constants(arb_ptr t, slong bits) {
    arb_ptr term = t + TERM, other = t + OTHER;
    find_ratio(t + R_YZ, t, IY, IZ, IX, bits), find_ratio(t + R_XY, t, IX, IY, IZ, bits);
    find_part(t + A, t + LX, t + LY, t + R_YZ, bits), find_part(t + C, t + LZ, t + LY, t + R_XY, bits);
    arb_sqrt(other, t + R_YZ, bits), arb_div(t + B, t + A, other, bits);
    arb_sub(term, t + IZ, t + IY, bits), arb_abs(term, term), arb_div(term, t + IZ, term, bits);
    arb_mul(t + K_DUAL, term, t + EXCESS, bits), arb_sqrt(t + K_DUAL, t + K_DUAL, bits);
    arb_div(t + K_DUAL, t + K_DUAL, t + G, bits), arb_div(t + K_DUAL, t + K_DUAL, t + C, bits);
    if (arb_is_zero(t + EXCESS)) {
        arb_one(t + LANDEN);
    } else { // k^2/(1+k')^2
        arb_sqrt(term, t + R_XY, bits), arb_mul(term, term, t + B, bits), arb_div(term, term, t + C, bits);
        arb_add_ui(other, t + K_DUAL, 1, bits), arb_div(term, term, other, bits), arb_sqr(t + LANDEN, term, bits);
    }
    arb_add_ui(other, t + C, 1, bits), arb_div(t + RATIO, t + A, other, bits);
    arb_sub(term, t + IX, t + IZ, bits), arb_abs(term, term), arb_div(term, term, t + IX, bits);
    arb_div(term, term, t + IZ, bits);
    arb_sqrt(other, t + R_YZ, bits), arb_mul(term, term, other, bits);
    arb_mul(term, term, t + C, bits), arb_mul(t + RATE, term, t + G, bits);
    arb_div(t + SPEED, t + C, t + IZ, bits), arb_mul(term, t + RATIO, t + A, bits), arb_div(term, term, t + IX, bits);
    arb_add(t + SPEED, t + SPEED, term, bits), arb_mul(t + SPEED, t + SPEED, t + G, bits);
}

// The phases of the pole and of the start, by Carlson's integral, still to be multiplied by a factor.
static void find_phases(arb_ptr t, slong bits) {
    arb_ptr x = t + K_OF_K, y = t + K_OF_DUAL, term = t + TERM;
    arb_sqr(term, t + RATIO, bits);
    arb_mul(x, term, t + LANDEN, bits), arb_add_ui(x, x, 1, bits), arb_mul(x, x, t + LANDEN, bits);
    arb_add(y, t + LANDEN, term, bits);
    ball_carlson(t + POLE, t + LANDEN, x, y, bits), arb_mul(t + POLE, t + POLE, t + RATIO, bits);
    arb_div(x, t + LX, t + A, bits), arb_sqr(x, x, bits);
    arb_div(y, t + LZ, t + C, bits), arb_sqr(y, y, bits);
    arb_one(term), ball_carlson(t + START, x, y, term, bits);
    arb_div(term, t + LY, t + B, bits), arb_mul(t + START, t + START, term, bits);
}

// The argument z = z0 + zeta t, the nome, and the phase's rate.
static void find_argument(top_motion *m, arb_ptr t) {
    const slong bits = m->bits;
    const int side = m->is_turning ? -1 : 1;
    arb_ptr factor = t + OTHER, term = t + TERM, tau = BALL(m, tau);
    m->is_dual = arf_cmp_d(arb_midref(t + K_DUAL), 0.1716) < 0;
    arb_sqr(term, t + K_DUAL, bits);
    if (arb_is_zero(t + EXCESS)) {
        arb_const_pi(t + K_OF_DUAL, bits), arb_mul_2exp_si(t + K_OF_DUAL, t + K_OF_DUAL, -1);
    } else {
        ball_complete(t + K_OF_K, term, bits);
        arb_sqrt(term, t + R_XY, bits), arb_mul(term, term, t + B, bits), arb_div(term, term, t + C, bits);
        arb_sqr(term, term, bits), ball_complete(t + K_OF_DUAL, term, bits);
    }
    arb_const_pi(factor, bits), arb_mul_2exp_si(factor, factor, -1);
    arb_div(factor, factor, m->is_dual ? t + K_OF_DUAL : t + K_OF_K, bits);
    arb_add_ui(term, t + K_DUAL, 1, bits), arb_div(term, factor, term, bits);
    arb_mul(t + POLE, t + POLE, term, bits);
    if (m->is_dual) {
        if (!arb_is_zero(t + EXCESS)) arb_div(tau, t + K_OF_K, t + K_OF_DUAL, bits), arb_mul_2exp_si(tau, tau, -1);
        arb_mul(BALL(m, height), t + K_OF_K, factor, bits), arb_mul_2exp_si(factor, factor, -1);
    } else {
        arb_div(tau, t + K_OF_DUAL, t + K_OF_K, bits), arb_mul_2exp_si(tau, tau, 1);
        arb_mul_2exp_si(t + POLE, t + POLE, 1);
    }
    arb_mul(BALL(m, zeta), factor, t + RATE, bits), arb_mul(BALL(m, z0), factor, t + START, bits);
    ball_tumbling_start(m, t + POLE, side);
    arb_mul(term, BALL(m, slope_plus), BALL(m, zeta), bits), arb_mul_si(term, term, side, bits);
    arb_mul_2exp_si(BALL(m, kappa_plus), t + SPEED, -1);
    arb_add(BALL(m, kappa_plus), BALL(m, kappa_plus), term, bits);
    arb_mul_si(BALL(m, jump_plus), t + POLE, -2 * side, bits); // of the phase, by half period of form b
}

// The period of the momentum in the body, which does not circulate on the separatrix, and the turn about it.
static void find_period(top_motion *m, arb_ptr t) {
    const slong bits = m->bits;
    const int side = m->is_turning ? -1 : 1;
    arb_ptr period = BALL(m, momentum_period), turn = BALL(m, momentum_turn), pi = t + TERM;
    if (arb_is_zero(t + EXCESS)) return;
    arb_div(period, t + K_OF_K, t + RATE, bits), arb_mul_2exp_si(period, period, 2);
    arb_const_pi(pi, bits), arb_mul(turn, BALL(m, kappa_plus), period, bits);
    arb_addmul_si(turn, pi, side, bits);
    if (m->is_dual) arb_addmul_si(turn, BALL(m, jump_plus), 2, bits);
    arb_mul_2exp_si(turn, turn, 1);
}

// The attitude relative to the momentum, in the axes x, y, z.
static void relative(arb_ptr q, const top_motion *m, const arb_t time) {
    const slong bits = m->bits;
    acb_t plus, minus, phase;
    arb_t z, angle;
    fmpz_t turns;
    acb_init(plus), acb_init(minus), acb_init(phase), arb_init(z), arb_init(angle), fmpz_init(turns);
    arb_mul(z, BALL(m, zeta), time, bits), arb_add(z, z, BALL(m, z0), bits);
    ball_tumbling(plus, minus, turns, m, z);
    arb_mul(angle, BALL(m, kappa_plus), time, bits), arb_addmul_fmpz(angle, BALL(m, jump_plus), turns, bits);
    arb_sin_cos(acb_imagref(phase), acb_realref(phase), angle, bits);
    acb_abs(z, plus, bits), acb_abs(angle, minus, bits), arb_hypot(z, z, angle, bits);
    acb_div_arb(phase, phase, z, bits), acb_mul(plus, plus, phase, bits), acb_mul(minus, minus, phase, bits);
    arb_set(q, acb_realref(plus)), arb_set(q + 3, acb_imagref(plus));
    arb_set(q + 1, acb_realref(minus)), arb_set(q + 2, acb_imagref(minus));
    acb_clear(plus), acb_clear(minus), acb_clear(phase), arb_clear(z), arb_clear(angle), fmpz_clear(turns);
}

void ball_circulation(top_motion *m, const arb_t along, const arb_t across, const arb_t spin, const arb_t momentum) {
    const slong bits = m->bits;
    arb_ptr period = BALL(m, momentum_period), turn = BALL(m, momentum_turn);
    arb_sub(turn, along, across, ARF_PREC_EXACT), arb_mul(turn, turn, spin, bits), arb_abs(turn, turn);
    arb_const_pi(period, bits), arb_mul_2exp_si(period, period, 1), arb_div(period, period, turn, bits);
    arb_mul(turn, period, momentum, bits), arb_mul(period, period, across, bits);
}

// The period in which the axis of a symmetric body goes round the momentum, and by how much phi turns in it: by 2 pi if
// the axis goes round the vertical, by pi if it meets it.
static void find_coning(top_motion *m, int axis) {
    const slong bits = m->bits;
    int i;
    arb_ptr t = _arb_vec_init(11), up = t, momentum = t + 3, height = t + 6, size = t + 7, vertical = t + 8, jump[2];
    jump[0] = BALL(m, jump_plus), jump[1] = BALL(m, jump_minus);
    arb_one(vertical + 2), ball_into_body(up, BALL(m, q0), vertical, 1, bits);
    for (i = 0; i < 3; i++) {
        arb_mul(momentum + i, BALL(m, i1) + i, BALL(m, omega1) + i, bits);
        arb_addmul(size, momentum + i, momentum + i, bits), arb_addmul(height, momentum + i, up + i, bits);
    }
    arb_sqrt(size, size, bits);
    arb_const_pi(BALL(m, period), bits), arb_mul_2exp_si(BALL(m, period), BALL(m, period), 1);
    arb_mul(BALL(m, period), BALL(m, period), BALL(m, i1) + (axis + 1) % 3, bits);
    arb_div(BALL(m, period), BALL(m, period), size, bits);
    arb_add(jump[0], height, momentum + axis, bits), arb_sub(jump[1], height, momentum + axis, bits);
    if (m->regime == CONING)
        ball_circulation(m, BALL(m, i1) + axis, BALL(m, i1) + (axis + 1) % 3, BALL(m, omega1) + axis, size);
    for (i = 0; i < 2; i++) {
        const int sign = arb_is_zero(jump[i]) ? 0 : ball_sign(jump[i]);
        if (arb_contains_zero(jump[i]) && !arb_is_zero(jump[i])) {
            arb_indeterminate(jump[i]);
            continue;
        }
        arb_const_pi(jump[i], bits), arb_mul_si(jump[i], jump[i], sign, bits);
    }
    _arb_vec_clear(t, 11);
}

int ball_free_body(top_motion *m, const top_data *data) {
    int i, same = 0, zeros = 0, reason;
    arb_ptr t;
    ball_datum(BALL(m, i1), data, INERTIA1), ball_datum(BALL(m, i2), data, INERTIA2);
    ball_datum(BALL(m, i3), data, INERTIA3);
    if (!ball_given(m, data)) return UNDECIDED_BRANCH;
    for (i = 0; i < 3; i++) {
        zeros += arb_is_zero(BALL(m, omega1) + i);
        if (are_same(data, (i + 1) % 3, (i + 2) % 3)) same++, m->axis[2] = i;
    }
    m->regime = same == 3 || zeros > 1 ? ROTATING : same == 1 ? CONING : TUMBLING;
    arb_indeterminate(BALL(m, momentum_period)), arb_indeterminate(BALL(m, momentum_turn));
    arb_indeterminate(BALL(m, period)), arb_zero(BALL(m, jump_plus)), arb_indeterminate(BALL(m, jump_minus));
    if (m->regime == CONING && arb_is_zero(BALL(m, omega1) + m->axis[2])) m->regime = ROTATING;
    if (same) find_coning(m, same == 3 ? 2 : m->axis[2]);
    if (same == 1 && m->axis[2] != 2) { // it is not body z that goes round the momentum in that period
        arb_indeterminate(BALL(m, period)), arb_indeterminate(BALL(m, jump_minus));
    }
    if (m->regime != TUMBLING) return PROVED;
    t = _arb_vec_init(CONSTANTS);
    reason = find_class(m, t);
    if (reason == PROVED) {
        find_constants(t, m->bits), find_phases(t, m->bits), find_argument(m, t), find_period(m, t);
        arb_zero(t), relative(BALL(m, r0), m, t);
        for (i = 1; i < 4; i++) arb_neg(BALL(m, r0) + i, BALL(m, r0) + i);
    }
    _arb_vec_clear(t, CONSTANTS);
    return reason;
}

void ball_free_attitude(acb_t upper, acb_t lower, const top_motion *m, const arb_t time) {
    const slong bits = m->bits;
    int i;
    arb_ptr t = _arb_vec_init(16), q = t, turn = t + 4, other = t + 8, half = t + 12;
    _arb_vec_set(q, BALL(m, q0), 4);
    if (m->regime == TUMBLING) {
        relative(other, m, time), ball_quaternion_product(turn, BALL(m, r0), other, bits);
        arb_set(other, turn);
        for (i = 0; i < 3; i++) arb_mul_si(other + 1 + m->axis[i], turn + 1 + i, m->sign[i], bits);
        ball_quaternion_product(q, q, other, bits);
    } else {
        const int axis = m->axis[2], across = (axis + 1) % 3;
        for (i = 0; i < 3; i++) arb_mul_2exp_si(half + i, BALL(m, omega1) + i, -1);
        if (m->regime == CONING) { // about the momentum, then about the axis
            arb_div(other, BALL(m, i1) + axis, BALL(m, i1) + across, bits);
            arb_mul(turn, half + axis, other, bits), arb_sub(other, half + axis, turn, bits);
            arb_swap(half + axis, turn), rotate(q, half, time, bits);
            _arb_vec_zero(half, 3), arb_swap(half + axis, other);
        }
        rotate(q, half, time, bits);
    }
    acb_set_arb_arb(upper, q, q + 3), acb_set_arb_arb(lower, q + 1, q + 2);
    _arb_vec_clear(t, 16);
}
#endif
