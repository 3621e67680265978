// Stages of a Runge-Kutta step of one body, with the constants of its series (series/motion_series.h). C with vectors of three
// or four components, as a stage waits for the one before it.

typedef unsigned long long half_bits __attribute__((vector_size(8 * half)));

// A body without effects: the angular velocity and the vertical wait for themselves only, and the quaternion follows beside;
// see rigid_body.f90, which has the equations. Constants of the body over the moments of inertia, 1 and 1/2, times the size of
// the step.
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

static void find_plain_stages(int from, int to, const struct one_constants *e, const double *y, double h, int stages,
                              const double *a, const int *since, double *k, double *aside) {
    const half_vector one = {1, 1, 1, 1}, mobility = get_half(e->per_inertia), scale = h * mobility;
    const struct step_constants of = {.one = h * one,
                                      .half = h / 2 * one,
                                      .coupling = scale * get_half(e->coupling),
                                      .decay = scale * get_half(e->decay),
                                      .pull = *e->gravity * scale * get_half(e->pull),
                                      .swing = *e->gravity * scale * get_half(e->swing)};
    const half_vector inertia = get_half(e->inertia) / h;
    const double share = 1 / h;
    struct variables start = {get_half(y), mobility * get_half(y + half), {0}}, newest;
    vec axes[3];

    find_axes(y, 0, axes);
    memcpy(&start.g, &axes[2], sizeof axes[2]);
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
        put_half(k + numbers * i, &q_slope), put_half(k + numbers * i + half, &p_slope);
    }
}

// A body with effects: each stage waits for a vertical from the quaternion, which for a body without effects would double the
// cycles.

// Up to this angle, rad, cosines and sines are short series.
static const double small_angle = 0.8;

// The acceleration of the pivot in space axes, at an angle after that for which `swing` is. The series of both functions are
// cut off below 1e-19 where the angle is small; this costs less than half of what their calls do.
inlined half_vector pivot_at(const half_vector swing[2], double x) {
    const double z = -x * x;
    double even = 1, odd = 1;
    if (!(-z < small_angle * small_angle)) {
        even = cos(x), odd = sin(x);
    } else {
        _Pragma("GCC unroll 9") for (int n = 18; n > 0; n -= 2) {
            even = 1 + z * (1.0 / (n * (n - 1))) * even, odd = 1 + z * (1.0 / (n * (n + 1))) * odd;
        }
        odd *= x;
    }
    return even * swing[0] + odd * swing[1];
}

// Quaternion and momentum, or their rates.
struct affected {
    half_vector q, p;
};

inlined void add_slope(struct affected *sum, double weight, const double *row) {
    sum->q += weight * get_half(row), sum->p += weight * get_half(row + half);
}

// The rates at a time; `twice` is twice the inverse of the squared norm of q, `push` the acceleration of the pivot in space
// axes.
inlined struct affected rates_of(const struct motion_kinds *has, const struct one_constants *e, double t,
                                 const half_vector *push, const struct affected *now, double twice) {
    const half_vector q = now->q, q0 = component(q, 0), imaginary = shuffle(q, q, 1, 2, 3, 0), pivot = *push;
    const half_vector third = {0, 0, 1}, mobility = get_half(e->per_inertia);
    const half_vector g = twice * (component(q, 3) * imaginary + q0 * (shuffle(q, q, 2, 1, 0, 3) * (half_vector){-1, 1, 1, 0}))
                          - third;
    half_vector rotor = {0}, u = now->p, lift = (*e->gravity + pivot[2]) * g, w, rate = *e->torque_space[2] * g;
    if (has->rotor) {
        rotor = get_half(e->rotor[1]) + t * get_half(e->drive[1]), rotor = shuffle(rotor, rotor, 1, 2, 0, 3);
        u -= rotor, rate += get_half(e->torque) + get_half(e->momentum);
    }
    const half_vector total = u * mobility;
    w = total;
    if (has->frame == anyhow || has->torque == anyhow || has->push == anyhow) {
        const half_vector first = {1}, second = {0, 1};
        const half_vector x_by_q0 = shuffle(q, q, 0, 3, 2, 1) * (half_vector){1, -1, 1, 0};
        const half_vector y_by_q0 = shuffle(q, q, 3, 0, 1, 2) * (half_vector){1, 1, -1, 0};
        const half_vector x = twice * (component(q, 1) * imaginary + q0 * x_by_q0) - first;
        const half_vector y = twice * (component(q, 2) * imaginary + q0 * y_by_q0) - second;
        lift += component(pivot, 0) * x + component(pivot, 1) * y;
        rate += *e->torque_space[0] * x + *e->torque_space[1] * y;
        w -= *e->frame[0] * x + *e->frame[1] * y;
    }
    if (has->frame) w -= *e->frame[2] * g;
    rate += get_half(e->coupling) * (shuffle(total, total, 1, 2, 0, 3) * shuffle(total, total, 2, 0, 1, 3));
    rate += shuffle(lift, lift, 1, 2, 0, 3) * get_half(e->pull) - shuffle(lift, lift, 2, 0, 1, 3) * get_half(e->swing);
    if (has->rotor) rate += cross(&rotor, &total);
    rate -= get_half(e->decay) * w;
    if (has->drags & (of_moment + 1)) {
        const half_vector squares = w * w;
        const double power = power_of(squares[0] + squares[1] + squares[2], *e->drag[of_moment].power);
        rate -= power * (get_half(e->drag[of_moment].moment) * w);
    }
    if (has->drags & (of_force + 1)) {
        const half_vector arm = get_half(e->arm), v = cross(&w, &arm), squares = v * v;
        rate += *e->drag[of_force].moment * sqrt(squares[0] + squares[1] + squares[2]) * cross(&v, &arm);
    }
    return (struct affected){
        .q = component(w, 0) * ((half_vector){-0.5, 0.5, 0.5, -0.5} * shuffle(q, q, 1, 0, 3, 2))
             + (component(w, 1) * ((half_vector){-0.5, -0.5, 0.5, 0.5} * shuffle(q, q, 2, 3, 0, 1))
                + component(w, 2) * ((half_vector){-0.5, 0.5, -0.5, 0.5} * shuffle(q, q, 3, 2, 1, 0))),
        .p = rate,
    };
}

static void find_affected_stages(int from, int to, const struct motion_kinds *has, const struct one_constants *e, double t,
                                 const double *y, double h, int stages, const double *a, const int *since, const double *c,
                                 double *k) {
    const double twice = 2 / ((y[0] * y[0] + y[3] * y[3]) + (y[1] * y[1] + y[2] * y[2]));
    const double o[3] = {*e->frame[0], *e->frame[1], *e->frame[2]};
    double swings[2][half] = {{0}};
    half_vector pivot = {0};
    const struct affected start = {get_half(y), {y[half], y[half + 1], y[half + 2]}};
    const double *const last = from > 0 ? k + numbers * (from - 1) : y;
    struct affected newest = {get_half(last), get_half(last + half)};
    if (has->push) one_find_swings(of_pivot, 0, e, t, o, swings[0], swings[1]);
    const half_vector swing[2] = {get_half(swings[0]), get_half(swings[1])};
    for (int i = from; i <= to; ++i) {
        const double *weight = a + (long)stages * i;
        struct affected change = {{0}, {0}}, now = start;
        // The newest stage comes last, as all others are known before it.
        if (i > 1) add_slope(&change, weight[0], k);
        for (int j = since[i] - 1; j < i - 1; ++j) add_slope(&change, weight[j], k + numbers * j);
        now.q += h * change.q, now.p += h * change.p;
        if (i > 0) now.q += (h * weight[i - 1]) * newest.q, now.p += (h * weight[i - 1]) * newest.p;
        if (has->push) pivot = pivot_at(swing, *e->rate[of_pivot] * (c[i] * h));
        newest = rates_of(has, e, t + c[i] * h, &pivot, &now, twice);
        newest.p[half - 1] = 0;
        put_half(k + numbers * i, &newest.q), put_half(k + numbers * i + half, &newest.p);
    }
}

static void find_stages(int from, int to, int is_affected, const struct motion_kinds *has, const double *constants, double t,
                        const double *y, double h, int stages, const double *a, const int *since, const double *c, double *k,
                        double *aside) {
    const struct one_constants *const e = (const struct one_constants *)constants;
    if (is_affected) {
        find_affected_stages(from, to, has, e, t, y, h, stages, a, since, c, k);
    } else {
        find_plain_stages(from, to, e, y, h, stages, a, since, k, aside);
    }
}
