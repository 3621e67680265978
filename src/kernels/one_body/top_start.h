// Where the motion of a symmetric top starts, for top_series.h; space_frame_series.f90 has the equations.

// The rates of the state and of the height v, the second derivative of v, and the factors of the linear terms.
struct top_start {
    double rate[numbers], linear[numbers], fall;
};

// A rate w times a quaternion, with what rounding leaves of the product.
inlined void add_turn(double w, double w_rest, half_vector turned, half_vector *rate, half_vector *rest) {
    const half_vector product = w * turned, sum = *rate + product, part = sum - *rate;
    *rest += ((*rate - (sum - part)) + (product - part)) + w_rest * turned;
    for (int i = 0; i < half; ++i) (*rest)[i] += __builtin_fma(w, turned[i], -product[i]);
    *rate = sum;
}

// The rate of a quaternion that turns with w. At the finest tolerances it is rounded once, since with one more rounding in
// each term energy and momentum of some tops drift.
inlined half_vector rate_of_quaternion(const struct symmetric_top *top, const double *momentum, const double *w, half_vector p,
                                       int is_finest) {
    const half_vector turned[3] = {(half_vector){-0.5, 0.5, -0.5, 0.5} * shuffle(p, p, 1, 0, 3, 2),
                                   (half_vector){-0.5, 0.5, 0.5, -0.5} * shuffle(p, p, 2, 3, 0, 1),
                                   (half_vector){-0.5, -0.5, 0.5, 0.5} * shuffle(p, p, 3, 2, 1, 0)};
    if (!is_finest) return w[0] * turned[0] + w[1] * turned[1] + w[2] * turned[2];
    half_vector rate = w[2] * turned[2], rest = {0};
    for (int i = 0; i < half; ++i) rest[i] = __builtin_fma(w[2], turned[2][i], -rate[i]);
    for (int i = 0; i < 2; ++i)
        add_turn(w[i], __builtin_fma(-w[i], top->inertia, momentum[i]) / top->inertia, turned[i], &rate, &rest);
    return rate + rest;
}

inlined struct top_start find_start_of_top(const struct symmetric_top *top, const double *state, int is_finest) {
    struct top_start s;
    const double m = top->pull, w[3] = {state[0] / top->inertia, state[1] / top->inertia, top->turn_rate};
    const double *p = state + 2;
    const half_vector q = get_half(p);
    const half_vector form = divided_by_square((half_vector){2 * (p[1] * p[3] + p[0] * p[2]), 2 * (p[2] * p[3] - p[0] * p[1]),
                                                             p[0] * p[0] + p[3] * p[3], p[1] * p[1] + p[2] * p[2]},
                                               p);
    const double upper = form[2], lower = form[3], axis[3] = {form[0], form[1], upper - lower};
    const double square = __builtin_fma(w[1], w[1], __builtin_fma(w[0], w[0], top->fine)) + top->coarse;
    const double of_momentum = __builtin_fma(m, axis[2], -top->fine / 4) - top->coarse / 4;
    const half_vector quaternion_rate = rate_of_quaternion(top, state, w, q, is_finest);
    const half_vector of_quaternion = m * (half_vector){-lower, upper, upper, -lower} - square / 4;

    s.rate[0] = w[2] / 2 * state[1] - m * axis[1] * top->inertia;
    s.rate[1] = m * axis[0] * top->inertia - w[2] / 2 * state[0];
    put_half(s.rate + 2, &quaternion_rate);
    s.rate[6] = m * (w[0] * axis[1] - w[1] * axis[0]), s.rate[7] = 0;
    s.linear[0] = s.linear[1] = of_momentum;
    put_half(s.linear + 2, &of_quaternion);
    s.linear[6] = 4 * m * axis[2] - square, s.linear[7] = 0;
    s.fall = m
             * (w[2] * (w[0] * axis[0] + w[1] * axis[1]) - axis[2] * (w[0] * w[0] + w[1] * w[1])
                - m * (axis[0] * axis[0] + axis[1] * axis[1]));
    return s;
}
