// Stages of a Runge-Kutta step for one body with effects; see body_with_effects.f90, which has the equations. As body_stages.h,
// with what effects add. Both are kept: here each stage waits for a vertical from the quaternion, which for a body without
// effects would double the cycles.

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

// The slope, rates of the quaternion q and of the momentum p, at a time; `twice` is twice the inverse of the squared norm of q,
// `push` the acceleration of the pivot in space axes.
inlined void find_slope(const struct stage_effects *e, double t, const half_vector *push, const half_vector *attitude,
                        const half_vector *momentum, double twice, vector *slope) {
    const half_vector q = *attitude, p = *momentum, q0 = component(q, 0), imaginary = shuffle(q, q, 1, 2, 3, 0);
    const half_vector third = {0, 0, 1}, weight = get_half(e->weight), arm = get_half(e->arm);
    const half_vector g = twice * (component(q, 3) * imaginary + q0 * (shuffle(q, q, 2, 1, 0, 3) * (half_vector){-1, 1, 1, 0}))
                          - third;
    const half_vector pivot = *push, torque = get_half(e->torque_space);
    half_vector rotor = {0}, u = p, lift = e->gravity * g, w, rate = get_half(e->torque_body);
    if (e->has_rotor) rotor = get_half(e->rotor) + t * get_half(e->drive), u -= rotor;
    const half_vector total = u * get_half(e->mobility);
    w = total;
    lift += component(pivot, 2) * g, rate += component(torque, 2) * g;
    if (e->has_sides) {
        const half_vector frame = get_half(e->frame), first = {1}, second = {0, 1};
        const half_vector x_by_q0 = shuffle(q, q, 0, 3, 2, 1) * (half_vector){1, -1, 1, 0};
        const half_vector y_by_q0 = shuffle(q, q, 3, 0, 1, 2) * (half_vector){1, 1, -1, 0};
        const half_vector x = twice * (component(q, 1) * imaginary + q0 * x_by_q0) - first;
        const half_vector y = twice * (component(q, 2) * imaginary + q0 * y_by_q0) - second;
        lift += component(pivot, 0) * x + component(pivot, 1) * y;
        rate += component(torque, 0) * x + component(torque, 1) * y;
        w -= component(frame, 0) * x + component(frame, 1) * y;
    }
    if (e->turns) w -= e->frame[2] * g;
    rate += get_half(e->coupling) * (shuffle(u, u, 1, 2, 0, 3) * shuffle(u, u, 2, 0, 1, 3)) + cross(&lift, &weight);
    if (e->has_rotor) rate += cross(&rotor, &total);
    rate -= get_half(e->damping) * w;
    if (e->has_drag) {
        const half_vector squares = w * w;
        const double square = squares[0] + squares[1] + squares[2];
        const double power = e->drag_power < 0.5 || e->drag_power > 0.5 ? pow(square, e->drag_power) : sqrt(square);
        rate -= power * (get_half(e->drag) * w);
    }
    if (e->drag_force > 0) {
        const half_vector v = cross(&w, &arm), squares = v * v;
        rate += e->drag_force * sqrt(squares[0] + squares[1] + squares[2]) * cross(&v, &arm);
    }
    const half_vector turn = component(w, 0) * ((half_vector){-0.5, 0.5, 0.5, -0.5} * shuffle(q, q, 1, 0, 3, 2))
                             + (component(w, 1) * ((half_vector){-0.5, -0.5, 0.5, 0.5} * shuffle(q, q, 2, 3, 0, 1))
                                + component(w, 2) * ((half_vector){-0.5, 0.5, -0.5, 0.5} * shuffle(q, q, 3, 2, 1, 0)));
    from_halves(&turn, &rate, slope);
    slope[parts - 1][width - 1] = 0;
}

static void find_effects_stages(int from, int to, const struct stage_effects *e, double t, const double *y, double h,
                                const double *a, int stride, const double *c, double *k) {
    const double twice = 2 / ((y[0] * y[0] + y[3] * y[3]) + (y[1] * y[1] + y[2] * y[2]));
    const double turned = e->rate * t;
    half_vector swing[2] = {{0}}, pivot = {0};
    vector start[parts], newest[parts];
    get_parts(start, y), start[parts - 1][width - 1] = 0;
    get_parts(newest, from > 0 ? k + numbers * (from - 1) : y);
    if (e->vibrates) {
        const double even = cos(turned), odd = sin(turned);
        swing[0] = even * get_half(e->swing[0]) + odd * get_half(e->swing[1]);
        swing[1] = even * get_half(e->swing[1]) - odd * get_half(e->swing[0]);
    }
    for (int i = from; i <= to; ++i) {
        const double *weight = a + (long)stride * i;
        vector even[parts], odd[parts], now[parts];
        int j = 0;
        for_all(p, parts) even[p] = odd[p] = (vector){0}, now[p] = start[p];
        // The newest stage comes last, as all others are known before it.
        for (; j + 2 < i; j += 2) {
            for_all(p, parts) even[p] += weight[j] * load(k + numbers * j + width * p);
            for_all(p, parts) odd[p] += weight[j + 1] * load(k + numbers * (j + 1) + width * p);
        }
        if (j + 1 < i)
            for_all(p, parts) even[p] += weight[j] * load(k + numbers * j + width * p);
        if (i > 0)
            for_all(p, parts) now[p] = (start[p] + h * (even[p] + odd[p])) + (h * weight[i - 1]) * newest[p];
        const half_vector q = first_half(now), p = last_half(now);
        if (e->vibrates) pivot = pivot_at(swing, e->rate * (c[i] * h));
        find_slope(e, t + c[i] * h, &pivot, &q, &p, twice, newest);
        for_all(p, parts) memcpy(k + numbers * i + width * p, &newest[p], sizeof *newest);
    }
}
