// The start of the series of effects_series.h.

// What terms 0 and 1 are, and how a term enters the next one: columns for the components of U, G, X and Y.
struct first_terms {
    half_vector slope[5]; // term 1 of q, U, G, X, Y
    half_vector linear[12][2];
};

// Term 0 of a drag: takes its moment from `rate`, and its change with the angular velocity from `by_speed`, three columns.
// Returns whether it has a series.
inlined int find_drag(const struct drag *d, const half_vector *w, struct drag_terms *t, half_vector *rate,
                      half_vector by_speed[3]) {
    const half_vector x = apply(d->speed, w), products = x * x;
    const double square = products[0] + products[1] + products[2];
    double power = square;
    t->slope = 2 * x, t->moment = apply(d->moment, w);
    t->steep = 1, t->inverse = t->inner = t->rest = 0;
    if (d->power < 1 || d->power > 1) {
        if (!(square > 0)) return 0;
        power = d->power < 0.5 || d->power > 0.5 ? pow(square, d->power) : sqrt(square);
        t->steep = d->power * power / square, t->inverse = 1 / square;
    }
    for (int i = 0; i < 3; ++i) {
        const half_vector change = t->slope * get_half(d->speed[i]);
        by_speed[i] -= power * get_half(d->moment[i]) + t->steep * (change[0] + change[1] + change[2]) * t->moment;
    }
    *rate -= power * t->moment;
    return 1;
}

// Term 1, and how a term enters the next one. Returns whether there is a series.
inlined int find_first_terms(const struct series_effects *e, const struct kinds *has, const double *state, const double *pivot,
                             struct drag_terms *t, struct first_terms *f) {
    const half_vector unit[3] = {{1}, {0, 1}, {0, 0, 1}};
    const half_vector q = get_half(state), u = get_half(state + 4), g = get_half(state + 8), x = get_half(state + 12);
    const half_vector y = get_half(state + 16), h = get_half(state + 20), v = get_half(e->inverse_inertia), total = u * v;
    const half_vector w = total - (e->frame_rate[0] * x + e->frame_rate[1] * y + e->frame_rate[2] * g);
    const half_vector arm = get_half(e->arm), coupling = get_half(e->coupling), damping = get_half(e->damping);
    const half_vector is_steady = get_half(e->is_steady);
    const half_vector u_left = shuffle(u, u, 1, 2, 0, 3), u_right = shuffle(u, u, 2, 0, 1, 3);
    const double pull[3] = {e->gravity + pivot[2], pivot[0], pivot[1]};
    const half_vector moment[3] = {pull[0] * arm, pull[1] * arm, pull[2] * arm};
    half_vector rate = cross(&g, &moment[0]) - damping * w + (get_half(e->torque_body) - get_half(e->rotor_torque))
                       + (e->torque_space[2] * g + (e->torque_space[0] * x + e->torque_space[1] * y));
    half_vector by_speed[3], by_other[3];

    if (has->sides) rate += cross(&x, &moment[1]) + cross(&y, &moment[2]);
    for (int i = 0; i < 3; ++i) {
        // Constants and momenta that do not change are in one factor, which is that of the terms to come as well: if it were
        // rounded in another way, energy and momentum would drift.
        const half_vector one = unit[i], left = shuffle(one, one, 1, 2, 0, 3) * u_right;
        const half_vector right = u_left * shuffle(one, one, 2, 0, 1, 3);
        f->linear[i][0] = coupling * (is_steady * right + (1 - is_steady) * left) + v[i] * cross(&h, &one);
        by_other[i] = coupling * (is_steady * left + (1 - is_steady) * right);
        by_speed[i] = -damping * one;
        rate += f->linear[i][0] * u[i];
    }
    for (int i = 0; i < has->drags; ++i) {
        if (!find_drag(&e->drag[i], &w, &t[i], &rate, by_speed)) return 0;
    }
    f->slope[0] = component(w, 0) * ((half_vector){-0.5, 0.5, 0.5, -0.5} * shuffle(q, q, 1, 0, 3, 2))
                  + component(w, 1) * ((half_vector){-0.5, -0.5, 0.5, 0.5} * shuffle(q, q, 2, 3, 0, 1))
                  + component(w, 2) * ((half_vector){-0.5, 0.5, -0.5, 0.5} * shuffle(q, q, 3, 2, 1, 0));
    f->slope[1] = rate, f->slope[2] = cross(&g, &w);
    f->slope[3] = cross(&x, &w) + e->circle * y, f->slope[4] = cross(&y, &w) - e->circle * x;
    for (int i = 0; i < 3; ++i) {
        const half_vector one = unit[i];
        f->linear[i][0] += by_other[i] + v[i] * by_speed[i];
        f->linear[i][1] = v[i] * cross(&g, &one);
        f->linear[3 + i][0] = cross(&one, &moment[0]) + e->torque_space[2] * one - e->frame_rate[2] * by_speed[i];
        f->linear[3 + i][1] = cross(&one, &total);
        if (!has->sides) continue;
        f->linear[6 + i][0] = cross(&one, &moment[1]) + e->torque_space[0] * one - e->frame_rate[0] * by_speed[i];
        f->linear[6 + i][1] = e->frame_rate[1] * one;
        f->linear[9 + i][0] = cross(&one, &moment[2]) + e->torque_space[1] * one - e->frame_rate[1] * by_speed[i];
        f->linear[9 + i][1] = -e->frame_rate[0] * one;
    }
    return 1;
}
