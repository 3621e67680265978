// Taylor coefficients of many motions with analytic effects, one in each lane of a vector; see lane_effects.f90, which has
// the equations. As lane_series.h, with what effects add: further rows that turn with the body as the vertical does, the
// angular velocity with that of the frame, and powers of speeds. Without effects it would take 1.04 to 1.12 times the cycles of
// lane_series.h at the level v3, 1.26 to 1.29 times at v4, so both are kept.

// What the terms of a step have in common: the factor of the quotient, 1/s and y of drags in term 0, the momentum of the
// rotor.
struct start {
    double inverse[lanes], inverse_square[most_drags][lanes], power[most_drags][lanes], rotor[2][3][lanes];
};

// Sums of products for the next term: the rows that turn, the vertical first; gyroscopic products; numerator and quotient.
struct drag_sums {
    vector square, first, second, moment[3];
};
struct lane_sums {
    vector row[1 + most_turning][3], gyro[3], numerator[2], quotient;
    struct drag_sums drag[most_drags];
};

// The further rows that turn as the vertical does.
inlined int list_turning(const struct lane_kinds *has, int row[most_turning]) {
    int n = 0;
    if (has->turns) row[n++] = frame;
    if (has->twists) row[n++] = torque;
    if (has->vibrates) row[n++] = push, row[n++] = pull_back;
    return n;
}

// Adds the vector product of the first three rows and v.
inlined void add_cross(vector sum[3], const double *first, vector v1, vector v2, vector v3) {
    const vector a1 = get(first, 0), a2 = get(first, 1), a3 = get(first, 2);
    sum[0] += a2 * v3, sum[1] += a3 * v1, sum[2] += a1 * v2;
    sum[0] -= a3 * v2, sum[1] -= a1 * v3, sum[2] -= a2 * v1;
}

// Adds the products of the first factors in term (c, x) and the second in term (d, z).
inlined void add_products(const struct lane_kinds *has, const double *c, const double *x, const double *d, const double *z,
                          struct lane_sums *sum) {
    const vector v1 = get(d, w1), v2 = get(d, w2), v3 = get(d, w3);
    const double *a = has->turns ? x + lanes * total : c, *b = has->turns ? z + lanes * total : d;
    int turning[most_turning];
    const int n = list_turning(has, turning);

    sum->gyro[0] += get(a, 1) * get(b, 2), sum->gyro[1] += get(a, 2) * get(b, 0), sum->gyro[2] += get(a, 0) * get(b, 1);
    add_cross(sum->row[0], c + lanes * g1, v1, v2, v3);
    sum->numerator[0] += get(c, g1) * v1, sum->numerator[1] += get(c, g2) * v2;
    sum->quotient += get(c, quotient) * get(d, g3);
    for_all(i, n) add_cross(sum->row[1 + i], x + lanes * turning[i], v1, v2, v3);
    for_all(i, has->drags) {
        const double *first = x + lanes * (drags + of_drag * i), *second = z + lanes * (drags + of_drag * i);
        const vector y = get(first, drag_y), s = get(second, drag_s);
        struct drag_sums *f = &sum->drag[i];
        f->first += y * get(second, drag_t), f->second += y * s;
        for_all(j, 3) f->moment[j] += y * get(second, drag_u + j);
    }
}

// Adds the products w.u of two terms, which are the same in the other order.
inlined void add_speeds(const struct lane_kinds *has, const double *c, const double *z, struct lane_sums *sum) {
    for_all(i, has->drags) {
        const double *u = z + lanes * (drags + of_drag * i);
        sum->drag[i].square += get(c, w1) * get(u, drag_u) + get(c, w2) * get(u, drag_u + 1) + get(c, w3) * get(u, drag_u + 2);
    }
}

// What follows from a term of the angular velocity at once, and zeros for what follows from the products.
inlined void prepare_term(const struct lane_kinds *has, int lane, const struct lane_constants *e, double *now, double *z) {
    const vector v[3] = {get(now, w1), get(now, w2), get(now, w3)}, none = {0};
    put(now, quotient, none);
    if (has->turns) {
        for_all(i, 3) put(z, total + i, v[i] + get(z, frame + i));
    }
    for_all(d, has->drags) {
        const double *q = e->drag[d].speed[0] + lane;
        double *f = z + lanes * (drags + of_drag * d);
        put(f, drag_u, get(q, 0) * v[0] + get(q, 5) * v[1] + get(q, 4) * v[2]);
        put(f, drag_u + 1, get(q, 5) * v[0] + get(q, 1) * v[1] + get(q, 3) * v[2]);
        put(f, drag_u + 2, get(q, 4) * v[0] + get(q, 3) * v[1] + get(q, 2) * v[2]);
        put(f, drag_s, none), put(f, drag_t, none), put(f, drag_y, none);
    }
}

// What is linear in term k of the rate of the angular velocity with that of the frame, and the torques that are constant.
inlined void find_linear_rates(const struct lane_kinds *has, int k, int lane, const struct lane_constants *e,
                               const struct start *of, const double *now, const double *z, vector rate[3]) {
    const double *a = has->turns ? z + lanes * total : now;
    const double *a_last = k == 0 ? a : has->turns ? z - more + lanes * total : now - term;
    const vector gravity = get(e->gravity + lane, 0);
    vector lift[3];

    for_all(m, 3) lift[m] = gravity * get(now, g1 + m);
    if (has->vibrates) {
        for_all(m, 3) lift[m] += get(z, push + m);
    }
    for_all(m, 3) {
        const int left = (m + 1) % 3, right = (m + 2) % 3;
        rate[m] = lift[left] * get(e->pull[m] + lane, 0) - lift[right] * get(e->swing[m] + lane, 0)
                  - get(now, w1 + m) * get(e->decay[m] + lane, 0);
        rate[m] += get(of->rotor[0][m] + lane, 0) * get(a, right) - get(of->rotor[1][m] + lane, 0) * get(a, left);
        if (k == 0) {
            rate[m] += get(e->torque[m] + lane, 0);
        } else {
            rate[m] += get(e->drive[0][m] + lane, 0) * get(a_last, right) - get(e->drive[1][m] + lane, 0) * get(a_last, left);
        }
        if (has->twists) rate[m] += get(e->inverse_inertia[m] + lane, 0) * get(z, torque + m);
    }
}

// Term k of a drag from the products; subtracts the moment from the rate.
inlined void finish_drag(int k, int lane, const struct lane_drag *d, const double *inverse_square, const double *power,
                         const double *f0, double *f, const struct drag_sums *sum, vector rate[3]) {
    const vector b = get(d->power + lane, 0), y0 = get(power + lane, 0), s = sum->square;
    vector y = y0;
    if (k > 0) y = get(inverse_square + lane, 0) * ((1 + b) * sum->first * (1.0 / k) - sum->second + b * s * y0);
    put(f, drag_s, s), put(f, drag_t, k * s), put(f, drag_y, y);
    for_all(i, 3) {
        const vector v = sum->moment[i] + y * get(f0, drag_u + i);
        put(f, drag_v + i, v);
        rate[i] -= get(d->moment[i] + lane, 0) * v;
    }
}

// Finds the term behind the k-th, and the quotient and the drags of the k-th, as in lane_series.h.
inlined void append_affected(const struct lane_kinds *has, int k, int lane, const struct lane_constants *e,
                             const struct start *of, struct share s, double *c, double *x) {
    double *now = c + term * k, *next = now + term, *z = x + more * k, *z_next = z + more;
    struct lane_sums sum = {0};
    int turning[most_turning], i = (k + 1) / 2 - 1, j = k - i;
    const int n = list_turning(has, turning);
    vector rate[3];

    prepare_term(has, lane, e, now, z);
    find_linear_rates(has, k, lane, e, of, now, z, rate);
    if (k % 2 == 0) {
        const double *middle = c + term * (k / 2), *middle_more = x + more * (k / 2);
        add_products(has, middle, middle_more, middle, middle_more, &sum);
        add_speeds(has, middle, middle_more, &sum);
        for_all(d, has->drags) sum.drag[d].square *= 0.5;
    }
    for (; i >= 0; --i, ++j) {
        add_products(has, c + term * i, x + more * i, c + term * j, x + more * j, &sum);
        add_products(has, c + term * j, x + more * j, c + term * i, x + more * i, &sum);
        add_speeds(has, c + term * i, x + more * j, &sum);
    }
    for_all(d, has->drags) sum.drag[d].square *= 2;

    const vector numbers = sum.numerator[0] + sum.numerator[1];
    const vector q = (numbers - sum.quotient) * get(of->inverse + lane, 0);
    put(now, quotient, q), put(now, numerator, numbers);
    for_all(m, 3) rate[m] += get(e->coupling[m] + lane, 0) * sum.gyro[m];
    for_all(d, has->drags) {
        const int at = lanes * (drags + of_drag * d);
        finish_drag(k, lane, &e->drag[d], of->inverse_square[d], of->power[d], x + at, z + at, &sum.drag[d], rate);
    }
    for_all(r, n) {
        for_all(m, 3) {
            vector change = sum.row[1 + r][m];
            if (turning[r] == push) change += get(e->rate + lane, 0) * get(z, pull_back + m);
            if (turning[r] == pull_back) change -= get(e->rate + lane, 0) * get(z, push + m);
            put(z_next, turning[r] + m, scaled(change, s));
        }
    }
    for_all(m, 3) {
        const vector change = scaled(rate[m], s);
        put(next, w1 + m, has->turns ? change - get(z_next, frame + m) : change);
        put(next, g1 + m, scaled(sum.row[0][m], s));
    }
    put(next, angle, scaled(get(now, w3) + q, s));
}

#include "lane_effects_start.h"

inlined void expand_affected_with(const struct lane_kinds *has, int order, const struct lane_constants *e, const double *t,
                                  const double *side, const double *state, const double *share, const double *share_rest,
                                  double *c, double *x) {
    const int few = order < exact_shares ? order : exact_shares;
    struct start of;
    const vector none = {0};

    for (int lane = 0; lane < lanes; lane += width) {
        for (int row = w1; row <= angle; ++row) put(c + lane, row, get(state + lane, row));
        put(c + term * order + lane, quotient, none);
        put(c + term * order + lane, numerator, none);
        begin_rows(has, lane, e, get(t + lane, 0), get(side + lane, 0), c + lane, &of, x + lane);
    }
    for (int k = 0; k < few; ++k) {
        const struct share s = {share[k], share_rest[k], 1};
        for (int lane = 0; lane < lanes; lane += width) append_affected(has, k, lane, e, &of, s, c + lane, x + lane);
    }
    for (int k = few; k < order; ++k) {
        const struct share s = {share[k] + share_rest[k], 0, 0};
        for (int lane = 0; lane < lanes; lane += width) append_affected(has, k, lane, e, &of, s, c + lane, x + lane);
    }
}

// One effect has a build of its own, in which nothing is asked in loops.
static void expand_affected_lanes(int order, const struct lane_kinds *which, const struct lane_constants *e, const double *t,
                                  const double *side, const double *state, const double *share, const double *share_rest,
                                  double *c, double *x) {
#define try_kinds(...)                                                                                  \
    do {                                                                                                \
        const struct lane_kinds has = {__VA_ARGS__};                                                    \
        if (has.turns == which->turns && has.twists == which->twists && has.vibrates == which->vibrates \
            && has.drags == which->drags) {                                                             \
            expand_affected_with(&has, order, e, t, side, state, share, share_rest, c, x);              \
            return;                                                                                     \
        }                                                                                               \
    } while (0)
    const struct lane_kinds any = *which;
    try_kinds(0, 0, 0, 0);
    try_kinds(1, 0, 0, 0);
    try_kinds(0, 1, 0, 0);
    try_kinds(0, 0, 1, 0);
    try_kinds(0, 0, 0, 1);
    expand_affected_with(&any, order, e, t, side, state, share, share_rest, c, x);
}

#undef try_kinds
