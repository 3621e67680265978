// The start of a motion that is given in any way: quaternion or angles, rates of the angles or angular velocity. Sums and
// products of what is exact are exact, so that zeros are.
#include "balls.h"
#ifdef SPINTOP_FLINT
#include <math.h>

void ball_datum(arb_t x, const top_data *data, int which) {
    mag_t radius;
    mag_init(radius), mag_set_d(radius, data->radius[which]);
    arb_set_d(x, data->value[which]), arb_add_error_mag(x, radius);
    mag_clear(radius);
}

double ball_most(const arb_t x) {
    double bound;
    arf_t size;
    arf_init(size), arb_get_abs_ubound_arf(size, x, ARF_PREC_EXACT), bound = arf_get_d(size, ARF_RND_UP);
    arf_clear(size);
    return bound;
}

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
static int find_angles(arb_ptr t, arb_srcptr q, const top_data *data, slong bits) {
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
static int read_rates(arb_ptr omega, arb_srcptr q, const top_data *data, slong bits) {
    int i, is_known = 1;
    arb_ptr t = _arb_vec_init(8), turn = t + 5, fall = t + 6, term = t + 7;
    if (data->given & BY_OMEGA) {
        for (i = 0; i < 3; i++) ball_datum(omega + i, data, OMEGA + i);
    } else {
        ball_datum(turn, data, PHI_RATE), ball_datum(fall, data, THETA_RATE), ball_datum(omega + 2, data, SPIN);
        if (!(arb_is_zero(turn) && arb_is_zero(fall))) {
            is_known = find_angles(t, q, data, bits);
            arb_mul(term, turn, t + 2, ARF_PREC_EXACT), arb_mul(omega, term, t, ARF_PREC_EXACT);
            arb_mul(omega + 1, term, t + 1, ARF_PREC_EXACT);
            arb_addmul(omega, fall, t + 1, ARF_PREC_EXACT), arb_submul(omega + 1, fall, t, ARF_PREC_EXACT);
            if (!(data->given & BY_OMEGA3)) arb_addmul(omega + 2, turn, t + 3, ARF_PREC_EXACT);
        }
    }
    _arb_vec_clear(t, 8);
    return is_known;
}

int ball_given(arb_ptr q, arb_ptr omega, const top_data *data, slong bits) {
    int i;
    arb_t size;
    arb_init(size);
    read_attitude(q, data, bits);
    for (i = 0; i < 4 && data->given & BY_QUATERNION; i++) arb_addmul(size, q + i, q + i, ARF_PREC_EXACT);
    if (data->given & BY_QUATERNION && !arb_is_one(size)) {
        arb_sqrt(size, size, bits), _arb_vec_scalar_div(q, q, 4, size, bits);
    }
    arb_clear(size);
    return read_rates(omega, q, data, bits);
}
#endif
