// Stages of a Runge-Kutta step for one body; see rigid_body.f90, which has the equations. C with vectors of three or
// four components, as a stage waits for the one before it: the angular velocity and the vertical wait for themselves only,
// and the quaternion follows beside.

typedef unsigned long long half_bits __attribute__((vector_size(8 * half)));

// Those of the body, and 1 and 1/2, times the size of the step.
struct step_constants {
    half_vector one, half, coupling, decay, pull, swing;
};

// The quaternion, the angular velocity, and the vertical in body axes; or their changes.
struct variables {
    half_vector q, w, g;
};

inlined struct variables get_row(const double *row) {
    return (struct variables){get_half(row), get_half(row + half), get_half(row + 2 * half)};
}

inlined void put_row(double *row, const struct variables *v) {
    put_half(row, &v->q), put_half(row + half, &v->w), put_half(row + 2 * half, &v->g);
}

inlined void add_change(struct variables *sum, double weight, const struct variables *v) {
    sum->q += weight * v->q, sum->w += weight * v->w, sum->g += weight * v->g;
}

// The changes at the rates of a state, over the step.
inlined struct variables changes_at(const struct step_constants *of, const struct variables *now) {
    const half_vector q = now->q, w = now->w, g = now->g, turn = of->one * w, roll = of->half * w;
    const half_vector w_ahead = shuffle(w, w, 1, 2, 0, 3), w_behind = shuffle(w, w, 2, 0, 1, 3);
    const half_vector g_ahead = shuffle(g, g, 1, 2, 0, 3), g_behind = shuffle(g, g, 2, 0, 1, 3);
    const half_vector turn_ahead = shuffle(turn, turn, 1, 2, 0, 3), turn_behind = shuffle(turn, turn, 2, 0, 1, 3);
    const half_vector rolled = shuffle(q, q, 1, 0, 0, 0) * shuffle(roll, roll, 0, 0, 1, 2)
                               + shuffle(q, q, 2, 2, 3, 1) * shuffle(roll, roll, 1, 2, 0, 1);
    const half_bits sign = {1ULL << 63, 0, 0, 0};
    return (struct variables){
        .q = (half_vector)((half_bits)rolled ^ sign) - shuffle(q, q, 3, 3, 1, 2) * shuffle(roll, roll, 2, 1, 2, 0),
        .w = ((of->coupling * w_behind) * w_ahead - of->decay * w) + (of->pull * g_ahead - of->swing * g_behind),
        .g = g_ahead * turn_behind - g_behind * turn_ahead,
    };
}

static void find_stages(int from, int to, const struct stage_factors *body, const double *y, double h, int stages,
                        const double *a, const int *since, double *k, double *aside) {
    const half_vector one = {1, 1, 1, 1}, inertia = get_half(body->inertia) / h;
    const double share = 1 / h;
    const struct step_constants of = {h * one,
                                      h / 2 * one,
                                      h * get_half(body->coupling),
                                      h * get_half(body->decay),
                                      h * get_half(body->pull),
                                      h * get_half(body->swing)};
    struct variables start, newest;
    half_vector momentum;
    vector slope[parts];

    find_first_term(y, &start.q, &momentum, &start.g);
    start.w = get_half(body->mobility) * momentum;
    if (from == 1) {
        newest = changes_at(&of, &start);
        put_row(aside, &newest);
    }
    newest = get_row(aside + set_aside * (from - 1));
    for (int i = from; i <= to; ++i) {
        const double *weight = a + (long)stages * i;
        struct variables now = start, older;
        // The newest stage comes last, as all others are known before it.
        if (i > 1) older = get_row(aside), add_change(&now, weight[0], &older);
        for (int j = since[i] - 1; j < i - 1; ++j) {
            older = get_row(aside + set_aside * j), add_change(&now, weight[j], &older);
        }
        add_change(&now, weight[i - 1], &newest);
        newest = changes_at(&of, &now);
        put_row(aside + set_aside * i, &newest);
        const half_vector q_slope = share * newest.q, p_slope = inertia * newest.w;
        from_halves(&q_slope, &p_slope, slope);
        for_all(p, parts) memcpy(k + numbers * i + width * p, &slope[p], sizeof *slope);
    }
}
