// The whole turns of phi and psi where the closed form gives the attitude alone: of free bodies, and in axes of which z
// is not that of the top. (phi + psi)/2 is the argument of q0 + i q3, (phi - psi)/2 that of q1 + i q2. Neither moves
// faster than at half the angular velocity, which the energy bounds. Where the distances of two of its points from zero
// are together longer than the path between them can be, the path does not meet zero, and turns as its chord does.
#include "balls.h"
#ifdef SPINTOP_FLINT
#include <math.h>

// The steps of a motion, after which its turns are not counted any more.
enum { MOST_STEPS = 30000 };
// A component this close to zero, half of the distance through_pole, is on a pole, where phi and psi jump.
static const double on_pole = 0x1p-36;

double ball_most(const arb_t x) {
    double bound;
    arf_t size;
    arf_init(size), arb_get_abs_ubound_arf(size, x, ARF_PREC_EXACT), bound = arf_get_d(size, ARF_RND_UP);
    arf_clear(size);
    return bound;
}

double ball_least(const arb_t x) {
    double bound;
    arf_t size;
    arf_init(size), arb_get_abs_lbound_arf(size, x, 64), bound = arf_get_d(size, ARF_RND_DOWN);
    arf_clear(size);
    return bound;
}

// At least half the angular velocity of the motion: its square is at most twice the kinetic energy over the smallest
// moment of inertia, and gravity adds at most 2 m g l to the energy.
static double find_speed(const top_motion *m) {
    const slong bits = m->bits;
    const int is_free = m->regime >= ROTATING;
    double speed, least = ball_least(BALL(m, i1));
    int i;
    arb_ptr t = _arb_vec_init(2), energy = t, term = t + 1;
    for (i = 0; i < 3; i++) {
        arb_srcptr inertia = is_free ? BALL(m, i1) + i : i < 2 ? BALL(m, i1) : BALL(m, i3);
        arb_sqr(term, BALL(m, omega1) + i, bits), arb_addmul(energy, inertia, term, bits);
        least = fmin(least, ball_least(inertia));
    }
    if (!is_free) arb_abs(term, BALL(m, weight)), arb_mul_2exp_si(term, term, 2), arb_add(energy, energy, term, bits);
    arb_set_d(term, least), arb_div(energy, energy, term, bits);
    arb_sqrt(energy, energy, bits), arb_mul_2exp_si(energy, energy, -1);
    speed = ball_most(energy);
    _arb_vec_clear(t, 2);
    return isfinite(speed) ? speed : INFINITY;
}

// Arguments of both components at a time, and their distances from zero.
static int find_components(ball_turns *there, const top_motion *m, double t) {
    static const int real[2] = {Q0, Q1}, imaginary[2] = {Q3, Q2};
    const slong bits = m->bits;
    int i, reason;
    arb_ptr answer = _arb_vec_init(QUANTITIES + 1), size = answer + QUANTITIES;
    reason = ball_attitude(answer, m, t);
    for (i = 0; i < 2 && reason == PROVED; i++) {
        arb_srcptr x = answer + real[i], y = answer + imaginary[i];
        arb_hypot(size, x, y, bits);
        there->distance[i] = arb_is_finite(size) ? ball_least(size) : 0;
        there->angle[i] = atan2(arf_get_d(arb_midref(y), ARF_RND_NEAR), arf_get_d(arb_midref(x), ARF_RND_NEAR));
        if (arb_is_finite(size) && ball_most(size) < on_pole) reason = NO_ANGLES;
        else if (!(mag_get_d(arb_radref(x)) + mag_get_d(arb_radref(y)) < there->distance[i] / 16)) reason = TOO_WIDE;
    }
    there->time = t;
    _arb_vec_clear(answer, QUANTITIES + 1);
    return reason;
}

// An angle without its whole turns.
static double least_turn(double angle) { return remainder(angle, 6.283185307179586); }

// The start, with the turns of the given angles.
static int begin(ball_turns *turns, const top_motion *m, const top_data *data) {
    const double phi = data->value[PHI], psi = data->value[PSI];
    const int reason = find_components(turns, m, 0);
    turns->phi = phi, turns->psi = psi;
    if (reason != PROVED) return reason;
    if (!(fabs(least_turn(turns->angle[0] + turns->angle[1] - phi)) < 0.5)) return UNDECIDED_BRANCH;
    if (!(fabs(least_turn(turns->angle[0] - turns->angle[1] - psi)) < 0.5)) return UNDECIDED_BRANCH;
    turns->is_begun = 1;
    return PROVED;
}

// A step towards a time, as long as it can be.
static int advance(ball_turns *turns, const top_motion *m, double t, double speed) {
    const double way = t - turns->time;
    double step = 1.8 * fmin(turns->distance[0], turns->distance[1]) / speed;
    ball_turns there = *turns;
    for (;; step /= 2) {
        const double next = fabs(way) <= step ? t : turns->time + copysign(step, way);
        const double path = speed * fabs(next - turns->time) * (1 + 0x1p-40);
        double change[2];
        int i, reason;
        if (next == turns->time) return NO_ANGLES;
        reason = find_components(&there, m, next);
        there.steps++;
        if (reason != PROVED) return reason;
        for (i = 0; i < 2 && path < turns->distance[i] + there.distance[i]; i++)
            change[i] = least_turn(there.angle[i] - turns->angle[i]);
        if (i < 2) continue;
        there.phi += change[0] + change[1], there.psi += change[0] - change[1];
        *turns = there;
        return PROVED;
    }
}

int ball_count_turns(ball_turns *turns, const top_motion *m, const top_data *data, double t) {
    const double speed = find_speed(m);
    int reason = !isfinite(speed) ? TOO_WIDE : turns->is_begun ? PROVED : begin(turns, m, data);
    while (reason == PROVED && turns->time != t)
        reason = turns->steps < MOST_STEPS ? advance(turns, m, t, speed) : TOO_MANY_TURNS;
    return reason;
}
#endif
