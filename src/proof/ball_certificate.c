// Bounds of printed numbers: the interface to certificate.f90, and the choice of the precision.
#include "balls.h"
#ifdef SPINTOP_FLINT
#include <math.h>
#include <stdlib.h>

// The precisions that are tried one after the other, bits: whole words with some bits for sums.
static const slong precisions[] = {112, 176, 240, 368, 560, 880};
// With radii of data, steps at the first precision are as good as they can be where widths are beyond this.
static const double rounding_of_steps = 0x1p-60;
enum { LEVELS = sizeof precisions / sizeof *precisions };

// A motion at the precisions that were needed so far.
typedef struct {
    top_data data;
    int has_radii;
    ball_tube *tube[LEVELS];
    int reason[LEVELS];
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
    int level;
    for (level = 0; proof && level < LEVELS; level++) ball_tube_close(proof->tube[level]);
    free(proof);
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

// Whether one of two components is zero but for the width of its ball: a body that stays on a pole.
static int is_middle_zero(arb_srcptr x, arb_srcptr y) { return arf_is_zero(arb_midref(x)) && arf_is_zero(arb_midref(y)); }

// phi and psi with their whole turns: those that are counted, or on a way over a pole those of the printed angles.
static int find_turns(arb_ptr answer, const double turned[2], const double printed[], slong bits) {
    int i;
    if (!(arb_is_finite(answer + ANGLE_PHI) && arb_is_finite(answer + ANGLE_PSI)))
        return is_middle_zero(answer + Q0, answer + Q3) || is_middle_zero(answer + Q1, answer + Q2) ? NO_ANGLES : TOO_WIDE;
    for (i = 0; i < 2; i++) {
        if (mag_cmp_2exp_si(arb_radref(answer + ANGLE_PHI + i), 0) > 0) return TOO_WIDE;
        add_turns(answer + ANGLE_PHI + i, isnan(turned[i]) ? printed[ANGLE_PHI + i] : turned[i], bits);
    }
    return PROVED;
}

// Bounds of the wanted quantities at a time. A reason other than PROVED goes with an infinite bound. Returns the
// bits of the highest precision that was used.
int spintop_proof_bounds(top_proof *proof, double t, const int wanted[QUANTITIES], int certified, double printed[QUANTITIES],
                         double bound[QUANTITIES], int reason[QUANTITIES]) {
    int level, i, open = 1, used = 0, is_last = 0;
    double last_width = INFINITY, now_width, turned[2];
    arb_ptr answer = _arb_vec_init(QUANTITIES);
    for (i = 0; i < QUANTITIES; i++) bound[i] = INFINITY, reason[i] = wanted[i] ? TOO_WIDE : PROVED;
    for (level = 0; open && !is_last && level < LEVELS; level++) {
        const slong bits = precisions[level];
        int why, turns = PROVED;
        if (!proof->tube[level]) proof->tube[level] = ball_tube_open(&proof->data, bits, proof->reason + level);
        why = proof->reason[level], used = (int)bits, open = 0;
        if (why == PROVED) why = ball_tube_answer(answer, turned, proof->tube[level], t);
        if (why == PROVED) turns = find_turns(answer, turned, printed, bits);
        if (why == PROVED && proof->has_radii) {
            now_width = width(answer, wanted), is_last = now_width > 0.5 * last_width || now_width > rounding_of_steps;
            last_width = now_width;
        }
        is_last = is_last || (proof->has_radii && level >= 1);
        for (i = 0; i < QUANTITIES; i++) {
            if (!wanted[i] || reason[i] == PROVED) continue;
            reason[i] = why != PROVED ? why : i == ANGLE_PHI || i == ANGLE_PSI ? turns : PROVED;
            if (reason[i] == PROVED) {
                reason[i] = TOO_WIDE;
                if (are_narrow(answer, i) || (is_last && (i == ORIENTATION || arb_is_finite(answer + i)))) {
                    bound[i] = bound_of(answer, i, printed, certified, bits);
                    if (isfinite(bound[i])) reason[i] = PROVED;
                }
            }
            open = open || reason[i] == TOO_WIDE || reason[i] == NO_START;
        }
    }
    _arb_vec_clear(answer, QUANTITIES);
    return used;
}

int spintop_proof_library(void) { return 1; }
#endif
