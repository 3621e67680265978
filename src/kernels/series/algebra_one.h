// The algebra of one body for motion_series.h: a vector of the body is one of four numbers, with a number to spare, kept with
// its cyclic permutations, as a load costs less than a permutation. The attitude is the quaternion.

#define stride 1
#define at_once 1
#define room (3 * half)
#define components half
#define attitude_room (3 * half)
#define has_registers 1
#define most_turned many_rows
#if defined(__AVX512F__)
#define pairs_for far_unrolled_for
#else
#define pairs_for unrolled_for
#endif
#define is_many 0

typedef double num;
typedef half_vector vec;
typedef struct {
    vec first, next, last;
} attitude_sums;

inlined num load_num(const double *row) { return *row; }
inlined void store_num(double *row, num a) { *row = a; }
inlined vec load_vec(const double *row) { return get_half(row); }
inlined vec load_constant(const double *row) { return get_half(row); }
inlined void store_constant(double *row, vec a) { put_half(row, &a); }
inlined vec vec_of(num x, num y, num z) { return (vec){x, y, z, z}; }
// The spare numbers are those that the products of the quaternion need.
inlined vec ahead(vec a) { return shuffle(a, a, 1, 2, 0, 1); }
inlined vec behind(vec a) { return shuffle(a, a, 2, 0, 1, 0); }
inlined vec load_ahead(const double *row) { return get_half(row + half); }
inlined vec load_behind(const double *row) { return get_half(row + 2 * half); }
inlined void store_vec(double *row, vec a) {
    const vec own = shuffle(a, a, 0, 1, 2, 2), next = ahead(a), last = behind(a);
    put_half(row, &own), put_half(row + half, &next), put_half(row + 2 * half, &last);
}
inlined vec add(vec a, vec b) { return a + b; }
inlined vec sub(vec a, vec b) { return a - b; }
inlined vec mul(vec a, vec b) { return a * b; }
inlined vec by(num a, vec b) { return a * b; }
inlined num sum_of(vec a) { return a[0] + (a[1] + a[2]); }

inlined num power_of(num s, num b) { return b < 0.5 || b > 0.5 ? pow(s, b) : sqrt(s); }
inlined void find_circle(num x, num *cosine, num *sine) { *cosine = cos(x), *sine = sin(x); }

// q' = q (0, w)/2, with q0 behind q1 to q3. The spare numbers of the products sum up to -2 q0'.
inlined void store_all(double *row, vec all) {
    const vec own = shuffle(all, all, 3, 3, 3, 2), next = shuffle(all, all, 1, 2, 0, 0), last = shuffle(all, all, 2, 0, 1, 1);
    put_half(row, &own), put_half(row + half, &next), put_half(row + 2 * half, &last);
}
inlined void store_attitude(double *row, num real, vec q) { store_all(row, (vec){q[0], q[1], q[2], real}); }
inlined void begin_attitude(double *now) { (void)now; }
inlined void add_attitude(attitude_sums *s, const double *older, const double *newer) {
    const double *q = older + 2 * room;
    s->first += get_half(q) * get_half(newer), s->next += get_half(q + half) * get_half(newer + 2 * half);
    s->last += get_half(q + 2 * half) * get_half(newer + half);
}
inlined void append_attitude(const attitude_sums *sum, num inverse, struct share s, double *now, double *next) {
    const vec all = sum->first + (sum->next + (vec){-1, -1, -1, 1} * sum->last), halved = {0.5, 0.5, 0.5, -0.5};
    const vec value = s.first * halved * all;
    (void)inverse, (void)now;
    store_all(next + 2 * room, s.is_sum ? value + s.rest * halved * all : value);
}
// Quaternion and momentum.
inlined void put_state(double *state, const double *now, vec momentum) {
    const vec own = get_half(now + 2 * room), next = get_half(now + 2 * room + half);
    const vec q = shuffle(own, next, 0, 6, 4, 5), p = shuffle(momentum, (vec){0}, 0, 1, 2, 4);
    put_half(state, &q), put_half(state + half, &p);
}
