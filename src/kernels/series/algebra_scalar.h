// The algebra of one body for motion_series.h in single numbers: in quadruple precision, and where vectors are of two numbers.
// NAME, the `element` and of_element(function) are set before.

#define stride 1
#define at_once 1
#define room 3
#define components half
#define attitude_room 4
#define has_registers 0
#define most_turned many_rows
#define pairs_for unrolled_for
#define is_many 0

typedef element num;

inlined num load_num(const element *row) { return *row; }
inlined void store_num(element *row, num a) { *row = a; }
#include "algebra_triples.h"
typedef struct {
    num real;
    vec imaginary;
} attitude_sums;

inlined num power_of(num s, num b) { return b < 0.5 || b > 0.5 ? of_element(pow)(s, b) : of_element(sqrt)(s); }
inlined void find_circle(num x, num *cosine, num *sine) { *cosine = of_element(cos)(x), *sine = of_element(sin)(x); }

// q' = q (0, w)/2.
inlined void store_attitude(element *row, num real, vec q) { store_vec(row, q), row[3] = real; }
inlined void begin_attitude(element *now) { (void)now; }
inlined void add_attitude(attitude_sums *s, const element *older, const element *newer) {
    const vec q = load_vec(older + 2 * room), w = load_vec(newer);
    s->real -= sum_of(mul(q, w));
    s->imaginary = add(s->imaginary, add(by(older[2 * room + 3], w), sub(mul(ahead(q), behind(w)), mul(behind(q), ahead(w)))));
}
inlined void append_attitude(const attitude_sums *sum, num inverse, struct share s, element *now, element *next) {
    (void)inverse, (void)now;
    const num first = s.first / 2, rest = s.is_sum ? s.rest / 2 : 0;
    store_attitude(next + 2 * room, first * sum->real + rest * sum->real,
                   add(by(first, sum->imaginary), by(rest, sum->imaginary)));
}
// Quaternion and momentum.
inlined void put_state(element *state, const element *now, vec momentum) {
    state[0] = now[2 * room + 3];
    store_vec(state + 1, load_vec(now + 2 * room)), store_vec(state + 4, momentum), state[7] = 0;
}
