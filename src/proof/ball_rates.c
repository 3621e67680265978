// The angular velocity in body axes: of a free body by its momentum, which is constant in space; of a top by its momenta
// and its energy, and by whether its axis rises. Nothing of it depends on phi.
#include "balls.h"
#ifdef SPINTOP_FLINT

// I^-1 R^T R0 (I omega0).
static void free_rates(arb_ptr omega, arb_srcptr q, const top_motion *m) {
    const slong bits = m->bits;
    int i;
    arb_ptr t = _arb_vec_init(10), momentum = t, in_space = t + 3, back = t + 6;
    for (i = 0; i < 3; i++) arb_mul(momentum + i, BALL(m, i1) + i, BALL(m, rate1) + i, bits);
    _arb_vec_set(back, BALL(m, q0), 4), _arb_vec_neg(back + 1, back + 1, 3);
    ball_into_body(in_space, back, momentum, 1, bits), ball_into_body(omega, q, in_space, 1, bits);
    for (i = 0; i < 3; i++) arb_div(omega + i, omega + i, BALL(m, i1) + i, bits);
    _arb_vec_clear(t, 10);
}

// With g the vertical in body axes, k that of the top, i and j the others: (omega_i g_i + omega_j g_j) + a g_k = b is
// constant, and so is omega_i^2 + omega_j^2 + beta g_k; g_k' = g_i omega_j - g_j omega_i.
static void top_rates(arb_ptr omega, arb_srcptr q, const top_motion *m, const arb_t time) {
    const slong bits = m->bits;
    const int k = m->body_axis, i = (k + 1) % 3, j = (k + 2) % 3, sign = m->is_flipped ? -1 : 1;
    const int rises = m->regime == STEADY ? 0 : sign * ball_rises(m, time);
    arb_srcptr first = BALL(m, rate1);
    arb_ptr t = _arb_vec_init(14), g = t, start = t + 3, z = t + 6, turn = t + 9, rise = t + 10, size = t + 11, fall = t + 12,
            term = t + 13;
    arb_one(z + 2), ball_into_body(g, q, z, 1, bits), ball_into_body(start, BALL(m, q0), z, 1, bits);
    arb_sub(fall, start + k, g + k, bits), arb_mul_si(fall, fall, sign, bits);
    arb_mul(turn, BALL(m, a), fall, bits), arb_addmul(turn, first + i, start + i, bits);
    arb_addmul(turn, first + j, start + j, bits);
    arb_sqr(size, g + i, bits), arb_addmul(size, g + j, g + j, bits);
    arb_mul(term, BALL(m, beta), fall, bits), arb_addmul(term, first + i, first + i, bits);
    arb_addmul(term, first + j, first + j, bits);
    arb_mul(rise, term, size, bits), arb_submul(rise, turn, turn, bits), arb_sqrtpos(rise, rise, bits);
    arb_neg(term, rise);
    if (m->regime == STEADY) arb_zero(rise);
    else if (rises < 0) arb_swap(rise, term);
    else if (rises == 0) arb_union(rise, rise, term, bits);
    arb_mul(omega + i, g + i, turn, bits), arb_submul(omega + i, g + j, rise, bits), arb_div(omega + i, omega + i, size, bits);
    arb_mul(omega + j, g + j, turn, bits), arb_addmul(omega + j, g + i, rise, bits), arb_div(omega + j, omega + j, size, bits);
    arb_set(omega + k, first + k);
    _arb_vec_clear(t, 14);
}

void ball_rates(arb_ptr answer, const top_motion *m, double t) {
    arb_ptr omega = answer + RATE1;
    arb_t time;
    arb_init(time), arb_set_d(time, t), _arb_vec_zero(omega, 3);
    if (m->regime == STEPPING) ball_tube_rates(omega, m);
    else if (t == 0 || m->regime == SLEEPING) _arb_vec_set(omega, BALL(m, rate1), 3);
    else if (m->regime >= ROTATING) free_rates(omega, answer + Q0, m);
    else top_rates(omega, answer + Q0, m, time);
    arb_clear(time);
}
#endif
