// Where the motion of a symmetric top starts, for top_series.h: computed with the numbers `real`, by the name `find_start`.
// space_frame.f90 has the equations.

inlined struct top_start find_start(const struct symmetric_top *top, const double *state) {
    const real m = top->pull, inertia = top->inertia, l0 = state[0], l1 = state[1];
    const real p0 = state[2], p1 = state[3], p2 = state[4], p3 = state[5];
    const real w0 = l0 / inertia, w1 = l1 / inertia, w2 = top->turn_rate;
    const real per_square = 1 / (((p0 * p0 + p3 * p3) + p1 * p1) + p2 * p2);
    const real upper = (p0 * p0 + p3 * p3) * per_square, lower = (p1 * p1 + p2 * p2) * per_square;
    const real e0 = 2 * (p1 * p3 + p0 * p2) * per_square, e1 = 2 * (p2 * p3 - p0 * p1) * per_square, e2 = upper - lower;
    const real aside = w0 * w0 + w1 * w1, square = aside + w2 * w2;
    const real rate[numbers] = {w2 / 2 * l1 - m * e1 * inertia,
                                m * e0 * inertia - w2 / 2 * l0,
                                -(w0 * p1 + w1 * p2 + w2 * p3) / 2,
                                (w0 * p0 + w1 * p3 - w2 * p2) / 2,
                                (w1 * p0 + w2 * p1 - w0 * p3) / 2,
                                (w2 * p0 + w0 * p2 - w1 * p1) / 2,
                                m * (w0 * e1 - w1 * e0)};
    const real of_momentum = m * e2 - w2 * w2 / 4, outer = -m * lower - square / 4, inner = m * upper - square / 4;
    const real linear[numbers] = {of_momentum, of_momentum, outer, inner, inner, outer, 4 * m * e2 - square};
    struct top_start s;
    for (int i = 0; i < numbers; ++i) {
        s.rate[i] = (double)rate[i], s.linear[i] = (double)linear[i];
        s.linear_rest[i] = (double)(linear[i] - s.linear[i]);
    }
    s.fall = (double)(m * (w2 * (w0 * e0 + w1 * e1) - e2 * aside - m * (e0 * e0 + e1 * e1)));
    return s;
}
