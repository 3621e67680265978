// Stages of a Runge-Kutta step for one body with effects; see effects_stages.f90, which has the equations. As body_stages.h,
// with what effects add. Both are kept: here each stage waits for a vertical from the quaternion, which for a body without
// effects would double the cycles.

typedef double state_row __attribute__((vector_size(8 * numbers)));

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

// The rate of the quaternion q and of the momentum p at a time; `twice` is twice the inverse of the squared norm of q,
// `push` the acceleration of the pivot in space axes.
inlined state_row slope_at(const struct stage_effects *e, double t, const half_vector *push, const half_vector *attitude,
                           const half_vector *momentum, double twice) {
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
    return shuffle(turn, rate, 0, 1, 2, 3, 4, 5, 6, 7);
}

static void find_effects_stages(int from, int to, const struct stage_effects *e, double t, const double *y, double h,
                                const double *a, int stride, const double *c, double *k) {
    const double twice = 2 / ((y[0] * y[0] + y[3] * y[3]) + (y[1] * y[1] + y[2] * y[2]));
    const double turned = e->rate * t;
    const state_row none = {0};
    half_vector swing[2] = {{0}}, pivot = {0};
    state_row start, newest = none;
    memcpy(&start, y, sizeof start);
    if (from > 0) memcpy(&newest, k + numbers * (from - 1), sizeof newest);
    if (e->vibrates) {
        const double even = cos(turned), odd = sin(turned);
        swing[0] = even * get_half(e->swing[0]) + odd * get_half(e->swing[1]);
        swing[1] = even * get_half(e->swing[1]) - odd * get_half(e->swing[0]);
    }
    for (int i = from; i <= to; ++i) {
        const double *weight = a + (long)stride * i;
        state_row even = none, odd = none, older, now = start;
        int j = 0;
        // The newest stage comes last, as all others are known before it.
        for (; j + 2 < i; j += 2) {
            memcpy(&older, k + numbers * j, sizeof older), even += weight[j] * older;
            memcpy(&older, k + numbers * (j + 1), sizeof older), odd += weight[j + 1] * older;
        }
        if (j + 1 < i) memcpy(&older, k + numbers * j, sizeof older), even += weight[j] * older;
        if (i > 0) now = (start + h * (even + odd)) + (h * weight[i - 1]) * newest;
        const half_vector q = shuffle(now, now, 0, 1, 2, 3), p = shuffle(now, none, 4, 5, 6, 8);
        if (e->vibrates) pivot = pivot_at(swing, e->rate * (c[i] * h));
        newest = slope_at(e, t + c[i] * h, &pivot, &q, &p, twice);
        newest[numbers - 1] = 0;
        memcpy(k + numbers * i, &newest, sizeof newest);
    }
}
