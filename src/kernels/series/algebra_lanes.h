// The algebra of bodies in lanes for motion_series.h: a number is a vector of the processor, of one number of each lane; a
// vector of the body has three of these. The attitude is the angle xi of lane_series.f90.

#define NAME(name) lanes_##name
#define element double

// A row has so many numbers, of which so many are computed at once; rows of a vector in a term, numbers of one in constants;
// rows that turn. Where the processor has 32 registers there is room for two sums instead of one, and for two turns of the
// loop.
#define stride lanes
#define at_once width
#define room 3
#define components 3
#define attitude_room 3
#define most_turned few_rows
#if defined(__AVX512F__)
#define has_registers 1
#define pairs_for unrolled_for
#else
#define has_registers 0
#define pairs_for for
#endif
#define is_many 1

typedef vector num;
typedef struct {
    vector along, across, quotient;
} attitude_sums;

inlined num load_num(const double *row) { return load(row); }
inlined void store_num(double *row, num a) { memcpy(row, &a, sizeof a); }
#include "algebra_triples.h"

// A power y = s^b of which the term follows from the recurrence; without s it is not finite: there is no series.
inlined num power_of(num s, num b) {
    num y;
    for (int i = 0; i < width; ++i) y[i] = b[i] < 0.5 || b[i] > 0.5 ? pow(s[i], b[i]) : sqrt(s[i]);
    return y;
}
inlined num inverse_of(num s) { return 1 / s; }
inlined num power_term(num b, num s, num y) { return (void)b, (void)s, y; }

// Cosine and sine to a unit or two in the last place. The quarters of a turn are taken off with pi/2 as the sum of three
// numbers, of which the first two have so few digits that the products are exact up to 10^6; then by the polynomials of fdlibm.
inlined void find_circle_of_few_turns(num x, num *cosine, num *sine) {
    const double round = 0x1.8p52, per_quarter = 0x1.45f306dc9c883p-1;
    const vector whole = x * per_quarter + round, n = whole - round;
    const vector r = ((x - n * 0x1.921fb544p0) - n * 0x1.0b4611a6p-34) - n * 0x1.3198a2e037073p-69, y = r * r;
    // clang-format off: the brackets would get a line each.
    const vector s = r + r * y * (-0x1.5555555555549p-3 + y * (0x1.111111110f8a6p-7 + y * (-0x1.a01a019c161d5p-13
        + y * (0x1.71de357b1fe7dp-19 + y * (-0x1.ae5e68a2b9cebp-26 + y * 0x1.5d93a5acfd57cp-33)))));
    const vector c = 1 - y * (0.5 - y * (0x1.555555555554cp-5 + y * (-0x1.6c16c16c15177p-10 + y * (0x1.a01a019cb1590p-16
        + y * (-0x1.27e4f809c52adp-22 + y * (0x1.1ee9ebdb4b1c4p-29 + y * -0x1.8fae9be8838d4p-37))))));
    // clang-format on
    const bits quarter = (bits)whole, swaps = -(quarter & 1);
    const bits cosine_of = ((bits)c & ~swaps) | ((bits)s & swaps), sine_of = ((bits)s & ~swaps) | ((bits)c & swaps);
    *cosine = (vector)(cosine_of ^ (((quarter + 1) & 2) << 62));
    *sine = (vector)(sine_of ^ ((quarter & 2) << 62));
}
inlined void find_circle(num x, num *cosine, num *sine) {
    const double exact = 1e6;
    find_circle_of_few_turns(x, cosine, sine);
    for (int i = 0; i < width; ++i) {
        if (x[i] > -exact && x[i] < exact) continue;
        (*cosine)[i] = cos(x[i]), (*sine)[i] = sin(x[i]);
    }
}

// xi' = w3 + Q, where Q (1 + s G3)/s = n - sum over j = 1..k of G3_j Q_(k - j), n = G1 w1 + G2 w2. The quotient of the newest
// term is zero while the products are found.
inlined void begin_attitude(double *now) { store_num(now + lanes * quotient, (num){0}); }
inlined void add_attitude(attitude_sums *s, const double *older, const double *newer) {
    s->along += load(older + lanes * g1) * load(newer + lanes * w1);
    s->across += load(older + lanes * g2) * load(newer + lanes * w2);
    s->quotient += load(older + lanes * g3) * load(newer + lanes * quotient);
}
inlined void append_attitude(const attitude_sums *sum, num inverse, struct share s, double *now, double *next) {
    const num n = sum->along + sum->across, q = (n - sum->quotient) * inverse;
    store_num(now + lanes * quotient, q), store_num(now + lanes * numerator, n);
    store_num(next + lanes * angle, scaled(load(now + lanes * w3) + q, s));
}

inlined void find_swing(num size, num x, num *even, num *odd) {
    find_circle(x, even, odd);
    *even *= size, *odd *= size;
}

// Space x and y in body axes are X = e - (e.G)/(1 + s G3) (G + s z) with e = (cos xi, -sin xi, 0), and Y with
// e = s (sin xi, cos xi, 0).
inlined void find_axes(const double *now, num s, vec axes[3]) {
    const vec g = load_vec(now + lanes * g1);
    const num inverse = 1 / (1 + s * g.z);
    vector cosine, sine;
    find_circle(load(now + lanes * angle), &cosine, &sine);
    const vector first = (g.x * cosine - g.y * sine) * inverse, second = s * (g.x * sine + g.y * cosine) * inverse;
    axes[0] = (vec){cosine - first * g.x, -sine - first * g.y, -first * (g.z + s)};
    axes[1] = (vec){s * sine - second * g.x, s * cosine - second * g.y, -second * (g.z + s)};
    axes[2] = g;
}
