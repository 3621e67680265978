// The three roots of the cubic of a top, proved to be real, to be these, and to lie in this order.
#include "balls.h"
#ifdef SPINTOP_FLINT

// beta y^3 + g2 y^2 + g1 y + g0 at y, or its derivative.
static void evaluate(arb_t f, const top_motion *m, const arb_t y, int is_slope) {
    const slong bits = m->bits;
    arb_t term;
    arb_init(term);
    if (is_slope) {
        arb_mul_ui(f, BALL(m, beta), 3, bits), arb_mul(f, f, y, bits);
        arb_mul_2exp_si(term, BALL(m, g2), 1), arb_add(f, f, term, bits);
        arb_mul(f, f, y, bits), arb_add(f, f, BALL(m, g1), bits);
    } else {
        arb_mul(f, BALL(m, beta), y, bits), arb_add(f, f, BALL(m, g2), bits);
        arb_mul(f, f, y, bits), arb_add(f, f, BALL(m, g1), bits);
        arb_mul(f, f, y, bits), arb_add(f, f, BALL(m, g0), bits);
    }
    arb_clear(term);
}

// The root near a guess: the only one in a ball, by interval Newton iteration. 0 if no ball is found.
static int enclose_root(arb_t root, const top_motion *m, const arb_t guess) {
    int i, is_found = 0;
    arb_ptr t = _arb_vec_init(4);
    arb_ptr y = t, f = t + 1, trial = t + 2, slope = t + 3;
    mag_t radius;
    mag_init(radius);
    arb_get_mid_arb(y, guess);
    for (i = 0; i < 2; i++) {
        evaluate(f, m, y, 0), evaluate(slope, m, y, 1), arb_div(f, f, slope, m->bits);
        if (!arb_is_finite(f)) break;
        arb_sub(y, y, f, m->bits), arb_get_mid_arb(y, y);
    }
    evaluate(f, m, y, 0);
    evaluate(slope, m, y, 1), arb_div(trial, f, slope, m->bits);
    arb_get_mag(radius, trial);
    for (i = 0; i < 8 && !is_found && mag_is_finite(radius); i++) {
        mag_mul_2exp_si(radius, radius, i == 0 ? 1 : 4);
        arb_set(trial, y), mag_add(arb_radref(trial), arb_radref(trial), radius);
        evaluate(slope, m, trial, 1);
        if (arb_contains_zero(slope)) break;
        arb_div(root, f, slope, m->bits), arb_sub(root, y, root, m->bits);
        is_found = arb_contains(trial, root);
    }
    mag_clear(radius);
    _arb_vec_clear(t, 4);
    return is_found;
}

// Guesses of the roots: the largest by Newton steps from above, which approach it from there; the others, of opposite
// signs, from their sum and product.
static void guess_roots(top_motion *m) {
    const slong bits = m->bits;
    slong i;
    arb_ptr t = _arb_vec_init(5), y = t, f = t + 1, slope = t + 2, product = t + 3, sum = t + 4;
    arb_abs(y, BALL(m, g0)), arb_div(y, y, BALL(m, beta), bits), arb_root_ui(y, y, 3, bits);
    arb_abs(f, BALL(m, g1)), arb_div(f, f, BALL(m, beta), bits), arb_sqrt(f, f, bits), arb_add(y, y, f, bits);
    arb_abs(f, BALL(m, g2)), arb_div(f, f, BALL(m, beta), bits), arb_add(y, y, f, bits);
    for (i = 0; i < 4 * bits; i++) {
        arb_get_mid_arb(y, y);
        evaluate(f, m, y, 0), evaluate(slope, m, y, 1), arb_div(f, f, slope, bits);
        if (!arb_is_finite(f) || arb_contains_zero(f)) break;
        arb_sub(y, y, f, bits);
        if (arb_rel_accuracy_bits(f) < 8) break;
    }
    arb_get_mid_arb(y, y), arb_set(BALL(m, y3), y);
    arb_div(product, BALL(m, g0), BALL(m, beta), bits), arb_div(product, product, y, bits);
    arb_neg(product, product);
    arb_div(sum, BALL(m, g1), BALL(m, beta), bits), arb_sub(sum, sum, product, bits), arb_div(sum, sum, y, bits);
    arb_sqr(f, sum, bits), arb_mul_2exp_si(slope, product, 2), arb_sub(f, f, slope, bits);
    arb_sqrt(f, f, bits);
    if (arf_sgn(arb_midref(sum)) < 0) arb_neg(f, f);
    arb_add(f, f, sum, bits), arb_mul_2exp_si(f, f, -1), arb_div(product, product, f, bits);
    arb_set(BALL(m, y1), f), arb_set(BALL(m, y2), product);
    if (arf_sgn(arb_midref(f)) > 0) arb_swap(BALL(m, y1), BALL(m, y2));
    _arb_vec_clear(t, 5);
}

// Roots for a start between them.
static int moving_start(top_motion *m) {
    arb_ptr y[3] = {BALL(m, y1), BALL(m, y2), BALL(m, y3)};
    int i, good = 1;
    guess_roots(m);
    for (i = 0; i < 3; i++) good = good && enclose_root(y[i], m, y[i]);
    return good && arb_is_negative(y[0]) && arb_is_positive(y[1]) && arb_lt(y[1], y[2]);
}

// Roots for a start where theta turns: y = 0 is one of them, the others are those of a quadratic.
static int turning_start(top_motion *m) {
    const slong bits = m->bits;
    arb_ptr t = _arb_vec_init(3), root = t, far = t + 1, near = t + 2;
    int side = ball_sign(BALL(m, g1)), good;
    m->starts_high = side < 0;
    arb_mul(root, BALL(m, beta), BALL(m, g1), bits), arb_mul_2exp_si(root, root, 2);
    arb_sqr(far, BALL(m, g2), bits), arb_sub(root, far, root, bits), arb_sqrt(root, root, bits);
    if (arf_sgn(arb_midref(BALL(m, g2))) < 0) arb_neg(root, root);
    arb_add(far, BALL(m, g2), root, bits), arb_mul_2exp_si(far, far, -1), arb_neg(far, far);
    arb_div(near, BALL(m, g1), far, bits), arb_div(far, far, BALL(m, beta), bits);
    if (arf_cmp(arb_midref(near), arb_midref(far)) > 0) arb_swap(near, far);
    good = side != 0 && arb_lt(near, far);
    if (m->starts_high) {
        arb_set(BALL(m, y1), near), arb_zero(BALL(m, y2));
        good = good && arb_is_negative(near) && arb_is_positive(far);
    } else {
        arb_zero(BALL(m, y1)), arb_set(BALL(m, y2), near);
        good = good && arb_is_positive(near);
    }
    arb_set(BALL(m, y3), far);
    _arb_vec_clear(t, 3);
    return good;
}

// Without gravity the cubic is a quadratic, and y3 is infinite.
static int free_start(top_motion *m) {
    const slong bits = m->bits;
    arb_ptr t = _arb_vec_init(2), root = t, far = t + 1;
    int good = arb_is_negative(BALL(m, g2));
    if (m->is_turning) {
        int side = ball_sign(BALL(m, g1));
        m->starts_high = side < 0;
        arb_div(far, BALL(m, g1), BALL(m, g2), bits), arb_neg(far, far);
        arb_set(BALL(m, y1), far), arb_set(BALL(m, y2), far);
        arb_zero(m->starts_high ? BALL(m, y2) : BALL(m, y1));
        good = good && side != 0;
    } else {
        arb_mul(root, BALL(m, g2), BALL(m, g0), bits), arb_mul_2exp_si(root, root, 2);
        arb_sqr(far, BALL(m, g1), bits), arb_sub(root, far, root, bits), arb_sqrt(root, root, bits);
        if (arf_sgn(arb_midref(BALL(m, g1))) < 0) arb_neg(root, root);
        arb_add(far, BALL(m, g1), root, bits), arb_mul_2exp_si(far, far, -1), arb_neg(far, far);
        arb_div(BALL(m, y1), far, BALL(m, g2), bits), arb_div(BALL(m, y2), BALL(m, g0), far, bits);
        if (arf_sgn(arb_midref(BALL(m, y1))) > 0) arb_swap(BALL(m, y1), BALL(m, y2));
        good = good && arb_is_negative(BALL(m, y1)) && arb_is_positive(BALL(m, y2));
    }
    arb_pos_inf(BALL(m, y3));
    _arb_vec_clear(t, 2);
    return good;
}

// A plane pendulum can rise by theta'^2/beta above its start.
static int plane_start(top_motion *m) {
    arb_t rise;
    int good = 1;
    m->starts_high = m->pole >= 0;
    arb_init(rise);
    arb_div(rise, BALL(m, swing), BALL(m, beta), m->bits);
    arb_neg(BALL(m, y1), BALL(m, ch));
    if (arb_lt(rise, BALL(m, sh))) {
        arb_set(BALL(m, y2), rise), arb_set(BALL(m, y3), BALL(m, sh));
    } else {
        good = arb_gt(rise, BALL(m, sh));
        arb_set(BALL(m, y2), BALL(m, sh)), arb_set(BALL(m, y3), rise);
    }
    arb_clear(rise);
    return good;
}

int ball_roots(top_motion *m) {
    int good;
    if (m->regime == FREE) good = free_start(m);
    else if (m->is_plane) good = plane_start(m);
    else good = m->is_turning ? turning_start(m) : moving_start(m);
    if (!good) return UNDECIDED_ROOTS;
    // A momentum that is exactly 0 makes a pole a root.
    m->meets_bottom = arb_is_zero(BALL(m, b_plus_a));
    if (m->meets_bottom) arb_neg(BALL(m, y1), BALL(m, ch));
    m->meets_top = 0;
    if (arb_is_zero(BALL(m, b_minus_a))) {
        m->meets_top = !arb_lt(BALL(m, y2), BALL(m, sh));
        if (m->meets_top && !arb_gt(BALL(m, y3), BALL(m, sh))) return UNDECIDED_ROOTS;
        arb_set(m->meets_top ? BALL(m, y2) : BALL(m, y3), BALL(m, sh));
    }
    return PROVED;
}
#endif
