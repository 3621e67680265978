// Bounds of printed numbers: the interface to certificate.f90, and the choice of the precision.
#include "balls.h"
#ifdef SPINTOP_FLINT
#include <math.h>
#include <stdlib.h>

// The precisions that are tried one after the other, bits; and those of any body, whole words with some bits for sums.
static const slong precisions[] = {128, 192, 288, 432, 648, 972, 1458, 2187, 3280, 4920, 7380, 11070, 16384, 0};
static const slong precisions_of_steps[] = {112, 176, 240, 368, 560, 880, 0};
// With radii of data, steps at the first precision are as good as they can be where widths are beyond this.
static const double rounding_of_steps = 0x1p-60;
enum { LEVELS = sizeof precisions / sizeof *precisions, LEVELS_OF_RADII = 3 };

// A top, and its motion at the precisions that were needed so far.
typedef struct {
    top_data data;
    int has_radii;
    top_motion *motion[LEVELS];
    int reason[LEVELS];
    ball_turns turns; // of phi and psi, counted so far
} top_proof;

void *spintop_proof_open(const double value[DATA], const double radius[DATA], int given) {
    top_proof *proof = calloc(1, sizeof *proof);
    int i;
    if (!proof) return NULL;
    for (i = 0; i < DATA; i++) {
        proof->data.value[i] = value[i], proof->data.radius[i] = radius[i];
        if (radius[i] > 0) proof->has_radii = 1;
    }
    proof->data.given = given;
    return proof;
}

void spintop_proof_close(top_proof *proof) {
    int level, i;
    if (!proof) return;
    for (level = 0; level < LEVELS; level++) {
        top_motion *m = proof->motion[level];
        if (!m) continue;
        for (i = 0; i < BALLS; i++) arb_clear(m->ball + i);
        acb_clear(m->w + PLUS), acb_clear(m->w + MINUS);
        ball_components_clear(&m->first), ball_tube_close(m->tube);
        free(m);
    }
    free(proof);
}

// Whether the axis comes so close to a pole, at most through_pole = 2^-35 rad, that it counts as passing through it.
static int passes_pole(const top_motion *m) {
    int passes;
    arb_t gap, least;
    arb_init(gap), arb_init(least);
    arb_set_d(least, 0x1p-71); // 1 - u or 1 + u, half of the square
    arb_sub(gap, BALL(m, sh), BALL(m, y2), m->bits), passes = arb_lt(gap, least);
    arb_add(gap, BALL(m, ch), BALL(m, y1), m->bits), passes = passes || arb_lt(gap, least);
    arb_clear(gap), arb_clear(least);
    return passes;
}

static slong bits_of_level(const top_proof *proof, int level) {
    return (proof->data.given & ANY_BODY ? precisions_of_steps : precisions)[level];
}

// The motion at a precision; NULL without memory.
static top_motion *motion_at_level(top_proof *proof, int level) {
    top_motion *m = proof->motion[level];
    int i, *reason = proof->reason + level;
    if (m) return m;
    m = proof->motion[level] = calloc(1, sizeof *m);
    if (!m) return NULL;
    for (i = 0; i < BALLS; i++) arb_init(m->ball + i);
    acb_init(m->w + PLUS), acb_init(m->w + MINUS);
    ball_components_init(&m->first);
    m->bits = bits_of_level(proof, level);
    if (proof->data.given & ANY_BODY) {
        m->regime = STEPPING, *reason = ball_tube_open(m, &proof->data);
        return m;
    }
    *reason = proof->data.given & FREE_BODY ? ball_free_body(m, &proof->data) : ball_start(m, &proof->data);
    if (m->regime == NUTATING || m->regime == FREE) {
        if (*reason == PROVED) *reason = ball_roots(m);
        if (*reason == PROVED) *reason = ball_phases(m);
    }
    m->meets_pole = m->regime == SLEEPING || m->pole || m->meets_top || m->meets_bottom;
    if (m->regime == NUTATING && *reason == PROVED) m->meets_pole = m->meets_pole || passes_pole(m);
    return m;
}

// The rotation from the attitude q to the printed one, which is normalised, as upper bound of its angle.
static double turn_between(arb_srcptr q, const double printed[], slong bits) {
    arb_ptr t = _arb_vec_init(4), length = t, chord = t + 1, part = t + 2, other = t + 3;
    double least = INFINITY;
    int i, side;
    arf_t bound;
    arf_init(bound);
    for (i = 0; i < 4; i++) arb_set_d(part, printed[Q0 + i]), arb_addmul(length, part, part, bits);
    arb_rsqrt(length, length, bits);
    for (side = -1; side < 2; side += 2) {
        arb_zero(chord);
        for (i = 0; i < 4; i++) {
            arb_set_d(part, printed[Q0 + i]), arb_mul(part, part, length, bits);
            arb_mul_si(other, q + Q0 + i, side, bits), arb_add(part, part, other, bits);
            arb_addmul(chord, part, part, bits);
        }
        arb_get_abs_ubound_arf(bound, chord, bits), arb_set_arf(chord, bound);
        arb_sqrt(chord, chord, bits), arb_mul_2exp_si(chord, chord, -1);
        arb_asin(chord, chord, bits), arb_mul_2exp_si(chord, chord, 2);
        if (arb_is_finite(chord)) least = fmin(least, ball_most(chord));
    }
    arf_clear(bound);
    _arb_vec_clear(t, 4);
    return least;
}

// Whether a radius is at most a quarter of the last place of max(|x|, 2^-52).
static int is_narrow(const arb_t x) {
    slong exponent;
    if (!arb_is_finite(x)) return 0;
    exponent = arf_abs_bound_lt_2exp_si(arb_midref(x));
    if (exponent < -51) exponent = -51;
    return mag_cmp_2exp_si(arb_radref(x), exponent - 55) <= 0;
}

static int are_narrow(arb_srcptr answer, int which) {
    int i;
    if (which != ORIENTATION) return is_narrow(answer + which);
    for (i = Q0; i <= Q3; i++)
        if (!arb_is_finite(answer + i) || mag_cmp_2exp_si(arb_radref(answer + i), -60) > 0) return 0;
    return 1;
}

// An angle that is known but for whole turns, with those of another one.
static void add_turns(arb_t angle, double near, slong bits) {
    arb_t turn;
    const double off = near - arf_get_d(arb_midref(angle), ARF_RND_NEAR);
    if (!(fabs(off) < 1e15)) return;
    arb_init(turn), arb_const_pi(turn, bits), arb_mul_2exp_si(turn, turn, 1);
    arb_addmul_si(angle, turn, (slong)floor(off / 6.283185307179586 + 0.5), bits);
    arb_clear(turn);
}

// phi and psi with their whole turns: those that are counted, or on a way over a pole those of the printed angles.
// Returns why they are not known.
static int find_turns(arb_ptr answer, top_proof *proof, const top_motion *m, double t, const int wanted[],
                      const double printed[]) {
    int reason = NO_ANGLES, i;
    if (ball_knows_turns(m) || !(wanted[ANGLE_PHI] || wanted[ANGLE_PSI])) return PROVED;
    if (!(arb_is_finite(answer + ANGLE_PHI) && arb_is_finite(answer + ANGLE_PSI))) return NO_ANGLES;
    if (m->regime == STEPPING) reason = ball_tube_turns(&proof->turns.phi, &proof->turns.psi, m);
    else if (ball_has_turns(m)) reason = ball_count_turns(&proof->turns, m, &proof->data, t);
    if (reason != PROVED && reason != NO_ANGLES) return reason;
    for (i = ANGLE_PHI; i <= ANGLE_PSI; i++) {
        if (mag_cmp_2exp_si(arb_radref(answer + i), 0) > 0) return TOO_WIDE;
        if (reason == NO_ANGLES) add_turns(answer + i, printed[i], m->bits);
        else add_turns(answer + i, i == ANGLE_PHI ? proof->turns.phi : proof->turns.psi, m->bits);
    }
    return PROVED;
}

// The bound of a printed number; with `certified` the number is the middle of its ball, or 0 if that is within.
static double bound_of(arb_srcptr answer, int which, double printed[], int certified, slong bits) {
    double bound;
    arb_t off;
    if (which == ORIENTATION) return turn_between(answer, printed, bits);
    if (certified) printed[which] = arb_contains_zero(answer + which) ? 0 : arf_get_d(arb_midref(answer + which), ARF_RND_NEAR);
    if (!isfinite(printed[which])) return INFINITY;
    arb_init(off), arb_set_d(off, printed[which]), arb_sub(off, off, answer + which, bits + 64);
    bound = ball_most(off);
    arb_clear(off);
    return bound;
}

// The sum of the radii of what is wanted: it stops falling when those of the data are all that is left.
static double width(arb_srcptr answer, const int wanted[]) {
    double sum = 0;
    int i;
    for (i = 0; i < QUANTITIES; i++) {
        if (!wanted[i]) continue;
        if (i != ORIENTATION) sum += arb_is_finite(answer + i) ? mag_get_d(arb_radref(answer + i)) : 0;
        else sum += width(answer, (const int[QUANTITIES]){1, 1, 1, 1});
    }
    return sum;
}

// Whether a quantity does not exist, whatever the precision; `turns` is what is known of the turns of phi and psi.
static int reason_of_absence(const top_motion *m, arb_srcptr answer, int which, int turns) {
    if (which == ANGLE_PHI || which == ANGLE_PSI) return turns;
    if (arb_is_finite(answer + which)) return PROVED;
    if (m->regime == STEPPING && which >= PERIOD && which <= MOMENTUM_TURN) return NO_CLOSED_FORM;
    if (which == MOMENTUM_PERIOD || which == MOMENTUM_TURN)
        return m->regime == TUMBLING && !arb_is_zero(BALL(m, tau)) ? PROVED : NO_CIRCULATION;
    if (which == PERIOD && m->regime == SLEEPING) return NO_PERIOD;
    if ((which == PERIOD || which == PRECESSION) && ball_has_turns(m) && !arb_is_finite(answer + PERIOD)) return NOT_PERIODIC;
    return PROVED;
}

// Whether one of some quantities is wanted.
static int is_wanted(const int wanted[], int first, int last) {
    while (first < last && !wanted[first]) first++;
    return wanted[first];
}

// Whether no other precision is to be tried.
static int is_final(int reason) {
    return reason == PROVED || reason == NO_ANGLES || reason == NO_PERIOD || reason == NOT_PERIODIC || reason == TOO_MANY_TURNS
           || reason == NO_CIRCULATION || reason == TOO_MANY_STEPS || reason == NO_CLOSED_FORM;
}

// Bounds of the wanted quantities at a time. A reason other than PROVED goes with an infinite bound. Returns the
// bits of the highest precision that was used.
int spintop_proof_bounds(top_proof *proof, double t, const int wanted[QUANTITIES], int certified, int most_bits,
                         double printed[QUANTITIES], double bound[QUANTITIES], int reason[QUANTITIES]) {
    int level, i, open = 1, used = 0, is_last, turns = PROVED;
    const int needs_rates = is_wanted(wanted, RATE1, RATE3);
    const int needs_attitude = needs_rates || wanted[ORIENTATION] || is_wanted(wanted, Q0, ANGLE_PSI);
    double last_width = INFINITY, now_width;
    arb_ptr answer = _arb_vec_init(QUANTITIES);
    for (i = 0; i < QUANTITIES; i++) bound[i] = INFINITY, reason[i] = wanted[i] ? TOO_WIDE : PROVED;
    for (level = 0; open && bits_of_level(proof, level) && bits_of_level(proof, level) <= most_bits; level++) {
        const top_motion *m = motion_at_level(proof, level);
        int why = m ? proof->reason[level] : TOO_WIDE;
        if (!m) break;
        used = (int)m->bits, is_last = 0, open = 0;
        if (why == PROVED) ball_periods(answer, m);
        if (why == PROVED && needs_attitude) why = ball_attitude(answer, m, t);
        if (why == PROVED && needs_rates) ball_rates(answer, m, t);
        if (why == PROVED) turns = find_turns(answer, proof, m, t, wanted, printed);
        if (why == PROVED && proof->has_radii) {
            now_width = width(answer, wanted);
            is_last = now_width > 0.5 * last_width || (m->regime == STEPPING && now_width > rounding_of_steps);
            last_width = now_width;
        }
        if (proof->has_radii && level >= (m->regime == STEPPING ? 1 : LEVELS_OF_RADII)) is_last = 1;
        for (i = 0; i < QUANTITIES; i++) {
            if (!wanted[i] || is_final(reason[i])) continue;
            reason[i] = why == PROVED ? reason_of_absence(m, answer, i, turns) : why;
            if (why == PROVED && reason[i] == PROVED) {
                reason[i] = TOO_WIDE;
                if (are_narrow(answer, i) || (is_last && (i == ORIENTATION || arb_is_finite(answer + i)))) {
                    bound[i] = bound_of(answer, i, printed, certified, m->bits);
                    if (isfinite(bound[i])) reason[i] = PROVED;
                }
            }
            open = open || !is_final(reason[i]);
        }
        if (is_last) break;
    }
    _arb_vec_clear(answer, QUANTITIES);
    return used;
}

int spintop_proof_library(void) { return 1; }
#endif
