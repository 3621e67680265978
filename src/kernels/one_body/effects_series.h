// Taylor coefficients of the motion of one body with effects; see smooth_effects_series.f90, which has the equations. As
// body_series.h, with what effects add: the newest term enters the next one by a matrix, `linear`, as all products of it
// with first terms are linear; only the products of the terms between are those of the effects. For a body without effects it
// would take 1.01 to 1.09 times the cycles of body_series.h at the level v3, 1.13 to 1.28 times at v4, so both are kept.

// A vector of a row for each term.
typedef vector row_series[most_terms][parts];

// Which effects there are.
struct kinds {
    int sides, drags, vibrates;
};

// Drag: s = x.x, y = s^b, and the moment -y z, where x and z are linear in the angular velocity.
//     a = (x1 x2 x3 k s  z1 z2 z3 s)    b = (x1 x2 x3 y  y y y y)
struct drag_terms {
    row_series a, b;
    half_vector slope, moment; // 2 x and z in term 0
    double steep, inverse;     // b y/s and 1/s in term 0
    double inner, rest;        // of the terms between in s and y, of the next term
};

// Factors of the products that effects add: of X and Y with U, as a0 to b1 of `struct factors`; G, X, Y; drags.
struct products {
    row_series x0, x1, b0, b1;
    half_vector rows[3][most_terms];
    struct drag_terms drag[2];
};

// Their sums for the next term, and that of the acceleration of the pivot in body axes.
struct effects_sums {
    vector side[parts], drag[2][parts];
    half_vector lift;
};

// The product of a matrix, as its columns, and a vector.
inlined half_vector apply(const double column[3][half], const half_vector *v) {
    return component(*v, 0) * get_half(column[0])
           + (component(*v, 1) * get_half(column[1]) + component(*v, 2) * get_half(column[2]));
}

// The term j of the acceleration of the pivot times the term i of the rows.
inlined half_vector pushed(const struct kinds *has, const double *pivot, int j, const struct products *o, int i) {
    const half_vector by_vertical = pivot[3 * j + 2] * o->rows[0][i];
    return has->sides ? by_vertical + (pivot[3 * j] * o->rows[1][i] + pivot[3 * j + 1] * o->rows[2][i]) : by_vertical;
}

// Adds the products of term i of the first factors and term j of the second.
inlined void add_pair(const struct kinds *has, const double *pivot, int i, int j, const struct products *o,
                      struct effects_sums *s) {
    if (has->sides) {
        for_all(p, parts) s->side[p] += o->x0[i][p] * o->b0[j][p];
        for_all(p, parts) s->side[p] += o->x1[i][p] * o->b1[j][p];
    }
    for (int d = 0; d < has->drags; ++d) {
        for_all(p, parts) s->drag[d][p] += o->drag[d].a[i][p] * o->drag[d].b[j][p];
    }
    if (has->vibrates) s->lift += pushed(has, pivot, j, o, i);
}

// Adds the products of the terms 2 to k - 1 to coefficient k + 1 of the rates, as add_inner_products, in one loop: its
// end cannot be foretold, which costs more than a product.
inlined void add_inner(const struct kinds *has, const double *pivot, int k, const struct factors *row, const struct products *o,
                       vector *s0, vector *s1, vector *s2, struct effects_sums *s) {
    vector t0[parts], t1[parts], t2[parts];
    struct effects_sums more = {0};
    int i = 2, j = k - 1;
    for_all(p, parts) t0[p] = t1[p] = t2[p] = (vector){0};
    for (; i < j; ++i, --j) {
        for_all(p, parts) {
            s0[p] += row[i].a0[p] * row[j].b0[p], t0[p] += row[j].a0[p] * row[i].b0[p];
            s1[p] += row[i].a1[p] * row[j].b1[p], t1[p] += row[j].a1[p] * row[i].b1[p];
            s2[p] += row[i].a2[p] * row[j].b2[p], t2[p] += row[j].a2[p] * row[i].b2[p];
        }
        add_pair(has, pivot, i, j, o, s), add_pair(has, pivot, j, i, o, &more);
    }
    if (i == j) {
        for_all(p, parts) t0[p] += row[i].a0[p] * row[i].b0[p];
        for_all(p, parts) t1[p] += row[i].a1[p] * row[i].b1[p];
        for_all(p, parts) t2[p] += row[i].a2[p] * row[i].b2[p];
        add_pair(has, pivot, i, i, o, s);
    }
    for_all(p, parts) s0[p] += t0[p], s1[p] += t1[p], s2[p] += t2[p];
    for_all(p, parts) s->side[p] += more.side[p], s->drag[0][p] += more.drag[0][p], s->drag[1][p] += more.drag[1][p];
    s->lift += more.lift;
}

// Adds the products of three columns and the components of a vector.
inlined void add_columns(half_vector column[3][2], const half_vector *v, vector *sum) {
    const half_vector v1 = component(*v, 0), v2 = component(*v, 1), v3 = component(*v, 2);
    vector c1[parts], c2[parts], c3[parts], b1[parts], b2[parts], b3[parts];
    memcpy(c1, column[0], sizeof c1), memcpy(c2, column[1], sizeof c2), memcpy(c3, column[2], sizeof c3);
    from_halves(&v1, &v1, b1), from_halves(&v2, &v2, b2), from_halves(&v3, &v3, b3);
    for_all(p, parts) sum[p] += c1[p] * b1[p] + (c2[p] * b2[p] + c3[p] * b3[p]);
}

// Puts X and Y in their arrangements, term k.
inlined void arrange_sides(const struct series_effects *e, int k, const vector *now, const vector *side,
                           const struct factors *f, struct products *s) {
    const half_vector u = first_half(now), x = first_half(side), y = last_half(side);
    const half_vector x0 = shuffle(x, x, 1, 2, 0, 3), y0 = shuffle(y, y, 1, 2, 0, 3), b1 = shuffle(u, u, 1, 2, 0, 3);
    const half_vector x1 = shuffle(x, x, 2, 0, 1, 3), y1 = shuffle(y, y, 2, 0, 1, 3);
    vector turn_first[parts], turn_second[parts];
    get_parts(turn_first, e->turn_first), get_parts(turn_second, e->turn_second);
    from_halves(&x0, &y0, s->x0[k]), from_halves(&x1, &y1, s->x1[k]), from_halves(&b1, &b1, s->b1[k]);
    for_all(p, parts) s->x0[k][p] *= turn_first[p], s->x1[k][p] *= turn_second[p], s->b0[k][p] = f->b0[p];
    s->rows[1][k] = x, s->rows[2][k] = y;
}

// Term k + 1 of X and Y, from term k and the products of the terms between.
inlined void append_sides(const struct series_effects *e, int k, const struct products *s, struct share share,
                          const vector *ahead, vector *side) {
    vector other[parts], up[parts], frame[2][parts];
    get_parts(frame[0], e->side_frame[0]), get_parts(frame[1], e->side_frame[1]);
    from_halves(&s->rows[2][k], &s->rows[1][k], other), from_halves(&s->rows[0][k], &s->rows[0][k], up);
    for_all(p, parts) {
        side[p] = scaled((ahead[p] + other[p] * frame[0][p] + up[p] * frame[1][p])
                             + (s->x0[k][p] * s->b0[0][p] + s->x0[0][p] * s->b0[k][p])
                             + (s->x1[k][p] * s->b1[0][p] + s->x1[0][p] * s->b1[k][p]),
                         share);
    }
}

// Term k of the factors of a drag, from that of the angular velocity.
inlined void append_drag(const struct drag *d, int k, const half_vector *w, struct drag_terms *t) {
    half_vector x = apply(d->speed, w), z = apply(d->moment, w);
    const half_vector products = x * t->slope;
    const double s = (products[0] + products[1]) + (products[2] + t->inner), y = t->steep * s + t->rest;
    const half_vector all = {y, y, y, y}, with_y = shuffle(x, all, 0, 1, 2, 7);
    x[3] = k * s, z[3] = s;
    from_halves(&x, &z, t->a[k]), from_halves(&with_y, &all, t->b[k]);
}

// The moments of the effects in term k + 1, but for what is linear in that term, from the sums of products.
inlined half_vector moment_of(const struct series_effects *e, const struct kinds *has, double share,
                              const struct effects_sums *s, const half_vector *total, struct products *o) {
    const half_vector none = {0}, arm = get_half(e->arm), drive = get_half(e->rotor_torque);
    half_vector moment = none;
    if (e->is_driven) moment = cross(total, &drive);
    moment = (has->vibrates ? cross(&s->lift, &arm) : none) - moment;
    for (int d = 0; d < has->drags; ++d) {
        struct drag_terms *t = &o->drag[d];
        const half_vector low = first_half(s->drag[d]), high = last_half(s->drag[d]);
        t->inner = low[0] + low[1] + low[2];
        t->rest = t->inverse * ((1 + e->drag[d].power) * share * low[3] - high[3]);
        moment -= shuffle(high, none, 0, 1, 2, 7) + t->moment * (t->steep * t->inner + t->rest);
    }
    return moment;
}

#include "effects_start.h"

// Factors for the products of a term with others, of which it is the first factor, and the second.
inlined void swap_factors(const vector *first, const vector *second, const vector *third, const struct factors *f,
                          struct factors *swapped) {
    for_all(p, parts) {
        swapped->a0[p] = first[p] * f->b0[p], swapped->b0[p] = first[p] * f->a0[p];
        swapped->a1[p] = second[p] * f->b1[p], swapped->b1[p] = second[p] * f->a1[p];
        swapped->a2[p] = third[p] * f->b2[p], swapped->b2[p] = third[p] * f->a2[p];
    }
}

inlined int expand_effects_with(const struct kinds *has, int order, const struct series_effects *e, const double *state,
                                const double *pivot, const double *share, const double *share_rest, double *c) {
    struct factors row[most_terms], start, next, f;
    struct products o;
    struct first_terms of;
    struct effects_sums sum = {0};
    vector first[parts], second[parts], third[parts];
    vector now[parts], side[parts], rate[parts], torque[2][parts], s1[parts], s2[parts], ahead[parts], more[parts];
    half_vector q, q_ahead = {0}, momentum, moment, total, w;
    const half_vector none = {0};

    if (!find_first_terms(e, has, state, pivot, o.drag, &of)) return 0;
    get_parts(first, e->first), get_parts(second, e->second), get_parts(third, e->third);
    memcpy(&q, state, sizeof q), get_parts(now, state + half), get_parts(side, state + half + numbers);
    memcpy(c, state, numbers * sizeof *c);
    arrange(now, &q, &f, torque);
    swap_factors(first, second, third, &f, &start);
    o.rows[0][0] = last_half(now);
    if (has->sides) arrange_sides(e, 0, now, side, &f, &o);
    total = get_half(e->inverse_inertia) * first_half(now);
    if (has->vibrates) sum.lift = pushed(has, pivot, 1, &o, 0);
    q = of.slope[0];
    from_halves(&of.slope[1], &of.slope[2], now), from_halves(&of.slope[3], &of.slope[4], side);

    for (int k = 1;; ++k) {
        // `now`, `side` and `q` are term k; `ahead`, `sum` and `q_ahead` the products of the terms 1 to k - 1.
        moment = moment_of(e, has, share[k - 1] + share_rest[k - 1], &sum, &total, &o);
        from_halves(&moment, &none, more);
        arrange(now, &q, &f, torque);
        momentum = first_half(now);
        put_half(c + numbers * k, &q), put_half(c + numbers * k + half, &momentum);
        if (k == order) return 1;
        const struct share s = share_of(share, share_rest, k);
        for_all(p, parts) {
            rate[p] = k > 1 ? ahead[p] + more[p] : more[p];
            s1[p] = start.b1[p] * f.b1[p] + start.a1[p] * f.a1[p];
            s2[p] = start.b2[p] * f.b2[p] + start.a2[p] * f.a2[p];
        }
        add_columns(of.linear, &momentum, rate);
        o.rows[0][k] = last_half(now);
        add_columns(of.linear + 3, &o.rows[0][k], rate);
        w = total = get_half(e->inverse_inertia) * momentum;
        if (e->turns) {
            w -= e->frame_rate[2] * o.rows[0][k];
            q_ahead += get_half(e->frame[0]) * shuffle(q, q, 1, 0, 3, 2) + get_half(e->frame[1]) * shuffle(q, q, 2, 3, 0, 1)
                       + get_half(e->frame[2]) * shuffle(q, q, 3, 2, 1, 0);
        }
        if (has->sides) {
            arrange_sides(e, k, now, side, &f, &o);
            add_columns(of.linear + 6, &o.rows[1][k], rate), add_columns(of.linear + 9, &o.rows[2][k], rate);
            w -= e->frame_rate[0] * o.rows[1][k] + e->frame_rate[1] * o.rows[2][k];
            append_sides(e, k, &o, s, sum.side, side);
        }
        for (int d = 0; d < has->drags; ++d) append_drag(&e->drag[d], k, &w, &o.drag[d]);
        for_all(p, parts) now[p] = scaled(rate[p], s);
        q = scaled_half(sum_of_halves(s1, s2) + q_ahead, s);
        // What the next term needs of those before it does not wait for that.
        if (k + 1 == order) continue;
        sum = (struct effects_sums){0};
        if (k == 1) {
            swap_factors(first, second, third, &f, &next);
            for_all(p, parts) ahead[p] = next.a0[p] * f.a0[p], s1[p] = next.a1[p] * f.a1[p], s2[p] = next.a2[p] * f.a2[p];
        } else {
            for_all(p, parts) {
                ahead[p] = next.a0[p] * f.a0[p] + next.b0[p] * f.b0[p];
                s1[p] = next.a1[p] * f.a1[p] + next.b1[p] * f.b1[p];
                s2[p] = next.a2[p] * f.a2[p] + next.b2[p] * f.b2[p];
            }
            add_inner(has, pivot, k, row, &o, ahead, s1, s2, &sum);
            for_all(p, parts) f.a0[p] *= first[p], f.a1[p] *= second[p], f.a2[p] *= third[p];
            row[k] = f;
            add_pair(has, pivot, 1, k, &o, &sum);
        }
        add_pair(has, pivot, k, 1, &o, &sum);
        if (has->vibrates) sum.lift += pushed(has, pivot, k + 1, &o, 0);
        add_last_half(ahead, s1);
        q_ahead = sum_of_halves(s1, s2);
    }
}

// One effect has a build of its own, in which nothing is asked in loops.
static void expand_effects(int order, const struct series_effects *e, const double *state, const double *pivot,
                           const double *share, const double *share_rest, double *c, int *exists) {
#define try_kinds(...)                                                                           \
    do {                                                                                         \
        const struct kinds has = {__VA_ARGS__};                                                  \
        if (has.sides == e->has_sides && has.drags == e->drags && has.vibrates == e->vibrates) { \
            *exists = expand_effects_with(&has, order, e, state, pivot, share, share_rest, c);   \
            return;                                                                              \
        }                                                                                        \
    } while (0)
    const struct kinds any = {e->has_sides, e->drags, e->vibrates};
    try_kinds(0, 0, 0);
    try_kinds(1, 0, 0);
    try_kinds(0, 1, 0);
    try_kinds(0, 0, 1);
    try_kinds(1, 0, 1);
    *exists = expand_effects_with(&any, order, e, state, pivot, share, share_rest, c);
}

#undef try_kinds
