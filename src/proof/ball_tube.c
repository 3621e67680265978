// The motion of any body: a polynomial, and around it a tube e in Q [-r, r] + the rest of a step, which contains the motion
// of the data: with radii, of all data within them. Then it is S p, too, p in [-1, 1] for each. Lengths of errors are in ulps.
#include "ball_tube.h"
#ifdef SPINTOP_FLINT
#include <math.h>
#include <stdlib.h>
#include <string.h>

// Steps of a motion, after which it is given up; the condition of the axes Q from which they are made orthogonal; and twice the
// distance from zero at which a component is on a pole, where phi and psi may jump: half of through_pole, 2^-35 rad.
enum { MOST_STEPS = 30000 };
static const double most_skew = 0x1p14, least_sum = 0x1p-35;

struct ball_tube {
    ball_field field;
    ball_step step;
    arb_ptr state, time; // exact, at the start of the step, time in units of time
    matrix axes;         // Q
    double radius[STATES], moved[STATES * RADII], next[STATES * RADII]; // S, and at the last point of the step
    slong halvings;                                                     // of h in the next step
    int steps, has_step, reach, reason;                                 // reach: where the step ends, in 64ths of h
    // phi and psi at the point `counted` of the step, whether they are known, and at the start.
    double counted, phi, psi, given[2];
    int has_turns;
};

// The start of the motion, forwards or backwards in time.
static void begin(ball_tube *tube, int sense) {
    const double ulps = ldexp(1, (int)tube->field.bits), turn = 6.283185307179586;
    double q[4], upper, lower;
    int i, c;
    tube->steps = tube->has_step = 0, tube->reason = PROVED, tube->step.sense = sense, tube->halvings = 2;
    memset(tube->axes, 0, sizeof tube->axes), arb_zero(tube->time);
    for (i = 0; i < STATES; i++) {
        AT(tube->axes, i, i) = 1, tube->radius[i] = mag_get_d(arb_radref(tube->field.start + i)) * ulps * SAFE;
        arb_set(tube->state + i, tube->field.start + i), mag_zero(arb_radref(tube->state + i));
        for (c = 0; c < tube->field.radii; c++)
            tube->moved[i * tube->field.radii + c] = arf_get_d(arb_midref(tube->field.moved[c].start + i), ARF_RND_NEAR) * ulps;
    }
    // Both angles, with their turns, are those of the components, which a negative sine or cosine of theta/2 turns over.
    for (i = 0; i < 4; i++) q[i] = arf_get_d(arb_midref(tube->state + i), ARF_RND_NEAR);
    upper = atan2(q[3], q[0]), lower = atan2(q[2], q[1]), tube->phi = tube->given[0], tube->psi = tube->given[1];
    tube->has_turns = fabs(remainder(upper + lower - tube->phi, turn)) < 0.5
                      && fabs(remainder(upper - lower - tube->psi, turn)) < 0.5;
}

// The step from here, and how far it goes; the next one is to use more than half of its h.
static int prepare(ball_tube *tube) {
    int far = 0;
    while (far <= 8 || (far > 64 && !tube->steps)) {
        if (labs(tube->halvings) > 200) return TOO_WIDE;
        tube->step.halvings = tube->halvings;
        ball_expand(&tube->step, tube->state, tube->time), far = ball_longest(&tube->step);
        tube->halvings += far > 64 ? -1 : far >= 32 ? 0 : far > 8 ? 1 : 3;
    }
    tube->reach = FLINT_MIN(far, 64), tube->counted = 0, tube->has_step = 1;
    ball_find_matrix(&tube->step, tube->reach / 64.0);
    return PROVED;
}

// The theorem: u, a bound of |e(s) - V(s) e(0) - Y(s) p|, and E, one of |e| up to s, where |e(0)| <= start.
static int bound(double *u, double *most, const ball_step *step, double start, double s) {
    const int n = step->field->order, count = 2 * n + 1;
    const double ulp = ldexp(1, -(int)step->field->bits), h = ldexp(1, -(int)step->halvings);
    const double a = ball_series(step->a, n + 1, s, 0), growth = exp(ball_series(step->growth, count, s, 1)) * SAFE;
    const double delta = s * step->lost + ball_series(step->tail + n, count, s, n + 1) + s * h * step->beyond * a * a;
    double bend;
    *most = 2 * growth * (start + delta + ball_series(step->forced, 3 * n + 3, s, 1)) * SAFE;
    bend = step->bend * s * *most * ulp;
    *u = (bend + ball_series(step->bent, count, s, 1)) * *most + delta + ball_series(step->left, 3 * n + 3 + MATRICES, s, 1);
    *u = growth * (*u + ball_series(step->defect, count + step->degree, s, 1) * start) * SAFE;
    return bend < 0.69 ? PROVED : TOO_WIDE;
}

// Continues phi and psi along the step to s. Between two points of a path, which are together farther from zero than it is
// long, it lies in an ellipse without zero and turns as its chord does. If they are so by `margin`, it is nowhere closer to
// zero than half of that.
static void count_turns(ball_tube *tube, double s, double margin) {
    const int n = tube->field.order;
    int side, k;
    for (side = PLUS; side <= MINUS; side++) { // q0 + i q3, q1 + i q2
        const double *x = tube->step.real + (side == PLUS ? 0 : 1) * (n + 1),
                     *y = tube->step.real + (side == PLUS ? 3 : 2) * (n + 1);
        double here = tube->counted, there = s, speed = 0;
        for (k = n; k > 0; k--) speed = speed * s + k * hypot(x[k], y[k]) * SAFE;
        while (here < s && tube->has_turns) {
            double z[2] = {0}, next[2] = {0};
            for (k = n; k >= 0; k--) {
                z[0] = z[0] * here + x[k], z[1] = z[1] * here + y[k];
                next[0] = next[0] * there + x[k], next[1] = next[1] * there + y[k];
            }
            if (speed * (there - here) + margin < hypot(z[0], z[1]) + hypot(next[0], next[1])) {
                const double turn = atan2(next[1] * z[0] - next[0] * z[1], next[0] * z[0] + next[1] * z[1]);
                tube->phi += turn, tube->psi += side == PLUS ? turn : -turn, here = there, there = s;
            } else {
                there = (here + there) / 2, tube->has_turns = there - here > 1e-13;
            }
        }
    }
    tube->counted = s;
}

// At a point of the step the error is in A z + S p + a ball of radius `rest`, |z_i| <= r_i.
static int spread(matrix a, double *rest, ball_tube *tube, double s) {
    const int radii = tube->field.radii;
    double start[STATES] = {0}, turned[STATES * RADII], most, size, width;
    matrix v;
    int i, j, reason;
    for (i = 0; i < STATES; i++)
        for (j = 0; j < STATES; j++) start[i] += fabs(AT(tube->axes, i, j)) * tube->radius[j];
    width = ball_length(tube->moved, radii);
    reason = bound(rest, &most, &tube->step, ball_norm(start, STATES) + width, s);
    if (reason != PROVED) return reason;
    count_turns(tube, s, least_sum + 2 * ldexp(most, -(int)tube->field.bits));
    size = ball_matrix_at(v, &tube->step, s, 0), ball_multiply(a, v, tube->axes, STATES);
    *rest += 16 * ROUNDING * size * (ball_norm(tube->axes, STATES * STATES) * ball_norm(tube->radius, STATES) + width);
    *rest += 16 * ROUNDING * ball_matrix_at(tube->next, &tube->step, s, 1);
    ball_multiply(turned, v, tube->moved, radii);
    for (i = 0; i < STATES * radii; i++) tube->next[i] += turned[i];
    return PROVED;
}

// X(s), in balls.
static void value_at(arb_ptr x, const ball_step *step, const arb_t s) {
    const int n = step->field->order;
    int c, k;
    for (c = 0; c < STATES; c++)
        for (arb_zero(x + c), k = n; k >= 0; k--) {
            arb_mul(x + c, x + c, s, step->field->bits), arb_add(x + c, x + c, SERIES(step, c) + k, step->field->bits);
        }
}

// Errors A z + a ball in new axes: A itself, until they are skew; then orthogonal ones.
static int change_axes(ball_tube *tube, const matrix a, double rest) {
    const double length = ball_norm(a, STATES * STATES) * ball_norm(tube->radius, STATES);
    double radius[STATES], error, size;
    matrix inverse, turned;
    int i, j, is_kept = ball_invert(inverse, a);
    is_kept = is_kept && ball_norm(inverse, STATES * STATES) * ball_norm(a, STATES * STATES) < most_skew;
    if (is_kept) memcpy(tube->axes, a, sizeof tube->axes);
    else ball_orthogonal(tube->axes, a, tube->radius);
    if (!is_kept && !ball_invert(inverse, tube->axes)) return TOO_WIDE;
    ball_multiply(turned, inverse, tube->axes, STATES), size = ball_norm(inverse, STATES * STATES);
    for (i = 0; i < STATES; i++) AT(turned, i, i) -= 1;
    error = ball_norm(turned, STATES * STATES) + 8 * ROUNDING * size * ball_norm(tube->axes, STATES * STATES);
    if (!(error < 0x1p-10)) return TOO_WIDE;
    ball_multiply(turned, inverse, a, STATES);
    for (i = 0; i < STATES; i++) {
        radius[i] = is_kept ? tube->radius[i] : (8 * ROUNDING + 2 * error) * size * length;
        for (j = 0; j < STATES && !is_kept; j++) radius[i] += fabs(AT(turned, i, j)) * tube->radius[j];
        radius[i] = (radius[i] + (ball_norm(inverse + i * STATES, STATES) + 2 * error * size) * rest) * SAFE;
    }
    memcpy(tube->radius, radius, sizeof radius);
    return PROVED;
}

// Over the step, whose end becomes the next start, rounded to ulps.
static int advance(ball_tube *tube) {
    const slong bits = tube->field.bits;
    int i, reason;
    double rest;
    matrix a;
    arb_ptr w = _arb_vec_init(STATES + 1), end = w, s = w + STATES;
    reason = spread(a, &rest, tube, tube->reach / 64.0);
    arb_set_si(s, tube->reach), arb_mul_2exp_si(s, s, -6), value_at(end, &tube->step, s);
    for (i = 0; i < STATES && reason == PROVED; i++) {
        arf_set_round(arb_midref(tube->state + i), arb_midref(end + i),
                      FLINT_MAX(2, bits + arf_abs_bound_lt_2exp_si(arb_midref(end + i))), ARF_RND_NEAR);
        arb_sub(end + i, end + i, tube->state + i, bits), arb_mul_2exp_si(end + i, end + i, bits), rest += ball_most(end + i);
    }
    if (reason == PROVED) reason = change_axes(tube, a, rest);
    memcpy(tube->moved, tube->next, sizeof tube->moved);
    arb_mul_si(s, s, tube->step.sense, ARF_PREC_EXACT), arb_mul_2exp_si(s, s, -tube->step.halvings);
    arb_add(tube->time, tube->time, s, ARF_PREC_EXACT), tube->has_step = 0;
    if (++tube->steps >= MOST_STEPS && reason == PROVED) reason = TOO_MANY_STEPS;
    _arb_vec_clear(w, STATES + 1);
    return reason;
}

// A time as point s of the step.
static void place_in_step(arb_t s, const ball_tube *tube, double t) {
    arb_set_d(s, t), arb_mul_2exp_si(s, s, tube->field.unit), arb_sub(s, s, tube->time, ARF_PREC_EXACT);
    arb_mul_si(s, s, tube->step.sense, ARF_PREC_EXACT), arb_mul_2exp_si(s, s, tube->step.halvings);
}

// The step that holds a time, after those before it; a time that lies back needs a new beginning.
static int reach_time(arb_t s, ball_tube *tube, double t) {
    const int sense = t < 0 ? -1 : 1;
    place_in_step(s, tube, t);
    if (sense != tube->step.sense || arf_cmp_d(arb_midref(s), tube->has_step ? tube->counted : 0) < 0) begin(tube, sense);
    while (tube->reason == PROVED) {
        if (!tube->has_step) tube->reason = prepare(tube);
        if (tube->reason != PROVED) break;
        place_in_step(s, tube, t), arb_mul_2exp_si(s, s, 6);
        if (arf_cmp_si(arb_midref(s), tube->reach) <= 0) break;
        tube->reason = advance(tube);
    }
    arb_mul_2exp_si(s, s, -6);
    return tube->reason;
}

// phi or psi of a quaternion, but for whole turns; NaN where the ball holds a pole.
static void find_angle(arb_t angle, arb_srcptr x, int side, slong bits) {
    acb_t upper, lower;
    arb_t pi;
    acb_init(upper), acb_init(lower), arb_init(pi), arb_const_pi(pi, bits);
    acb_set_arb_arb(upper, x, x + 3), acb_set_arb_arb(lower, x + 1, x + 2);
    if (side == MINUS) acb_conj(lower, lower);
    acb_mul(upper, upper, lower, bits);
    if (acb_contains_zero(upper)) {
        arb_indeterminate(angle);
    } else if (arb_contains_negative(acb_realref(upper))) { // away from the cut
        acb_neg(upper, upper), acb_arg(angle, upper, bits), arb_add(angle, angle, pi, bits);
    } else {
        acb_arg(angle, upper, bits);
    }
    acb_clear(upper), acb_clear(lower), arb_clear(pi);
}

int ball_tube_answer(arb_ptr answer, double turned[2], ball_tube *tube, double t) {
    const slong bits = tube->field.bits;
    int i, j, reason;
    double rest;
    matrix a;
    mag_t radius;
    arb_ptr x = _arb_vec_init(STATES + 3), s = x + STATES, high = s + 1, low = s + 2;
    mag_init(radius);
    reason = reach_time(s, tube, t);
    if (reason == PROVED) reason = spread(a, &rest, tube, arf_get_d(arb_midref(s), ARF_RND_NEAR));
    if (reason == PROVED) value_at(x, &tube->step, s);
    for (i = 0; i < STATES && reason == PROVED; i++) {
        double sum = rest;
        for (j = 0; j < STATES; j++) sum += fabs(AT(a, i, j)) * tube->radius[j];
        for (j = 0; j < tube->field.radii; j++) sum += fabs(tube->next[i * tube->field.radii + j]);
        mag_set_d(radius, sum * SAFE), mag_mul_2exp_si(radius, radius, -bits), arb_add_error_mag(x + i, radius);
    }
    _arb_vec_set(answer + Q0, x, 4), _arb_vec_set(answer + RATE1, x + 4, 3);
    ball_into_body(answer + RATE1, x, tube->field.turn, -1, bits);
    _arb_vec_scalar_mul_2exp_si(answer + RATE1, answer + RATE1, 3, tube->field.unit);
    arb_hypot(high, x, x + 3, bits), arb_hypot(low, x + 1, x + 2, bits);
    arb_atan2(answer + ANGLE_THETA, low, high, bits), arb_mul_2exp_si(answer + ANGLE_THETA, answer + ANGLE_THETA, 1);
    find_angle(answer + ANGLE_PHI, x, PLUS, bits), find_angle(answer + ANGLE_PSI, x, MINUS, bits);
    turned[0] = tube->has_turns ? tube->phi : NAN, turned[1] = tube->has_turns ? tube->psi : NAN;
    mag_clear(radius), _arb_vec_clear(x, STATES + 3);
    return reason;
}

ball_tube *ball_tube_open(const top_data *data, slong bits, int *reason) {
    ball_tube *tube = flint_calloc(1, sizeof *tube);
    int n;
    *reason = ball_field_init(&tube->field, data, bits), n = tube->field.order + 1;
    tube->step.field = &tube->field, tube->step.x = _arb_vec_init(STATES * n), tube->step.wave = _arb_vec_init(WAVES * n);
    tube->state = _arb_vec_init(STATES + 1), tube->time = tube->state + STATES;
    tube->given[0] = data->value[PHI], tube->given[1] = data->value[PSI];
    if (*reason == PROVED) begin(tube, 1);
    return tube;
}

void ball_tube_close(ball_tube *tube) {
    const int n = tube ? tube->field.order + 1 : 0;
    if (!tube) return;
    _arb_vec_clear(tube->step.x, STATES * n), _arb_vec_clear(tube->step.wave, WAVES * n);
    ball_field_clear(&tube->field), _arb_vec_clear(tube->state, STATES + 1);
    flint_free(tube);
}
#endif
