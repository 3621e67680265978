// The start of a step of lane_effects.h.

// Cosine and sine to a unit or two in the last place. The quarters of a turn are taken off with pi/2 as the sum of three
// numbers, of which the first two have so few digits that the products are exact; then by the polynomials of fdlibm.
inlined void find_circle(vector x, vector *cosine, vector *sine) {
    const double round = 0x1.8p52, exact = 1e6, per_quarter = 0x1.45f306dc9c883p-1;
    const vector whole = x * per_quarter + round, n = whole - round;
    const vector r = ((x - n * 0x1.921fb544p0) - n * 0x1.0b4611a6p-34) - n * 0x1.3198a2e037073p-69, y = r * r;
    // clang-format off: the brackets would get a line each.
    const vector s = r + r * y * (-0x1.5555555555549p-3 + y * (0x1.111111110f8a6p-7 + y * (-0x1.a01a019c161d5p-13
        + y * (0x1.71de357b1fe7dp-19 + y * (-0x1.ae5e68a2b9cebp-26 + y * 0x1.5d93a5acfd57cp-33)))));
    const vector c = 1 - y * (0.5 - y * (0x1.555555555554cp-5 + y * (-0x1.6c16c16c15177p-10 + y * (0x1.a01a019cb1590p-16
        + y * (-0x1.27e4f809c52adp-22 + y * (0x1.1ee9ebdb4b1c4p-29 + y * -0x1.8fae9be8838d4p-37))))));
    // clang-format on
    const bits quarter = (bits)whole, swaps = -(quarter & 1);
    const bits cosine_of = ((bits)c & ~swaps) | ((bits)s & swaps), sine_of = ((bits)s & ~swaps) | ((bits)c & swaps);
    *cosine = (vector)(cosine_of ^ (((quarter + 1) & 2) << 62));
    *sine = (vector)(sine_of ^ ((quarter & 2) << 62));
    for (int i = 0; i < width; ++i) {
        if (x[i] > -exact && x[i] < exact) continue;
        (*cosine)[i] = cos(x[i]), (*sine)[i] = sin(x[i]);
    }
}

// 1/s and y = s^b of a drag in term 0. Without a speed they are not finite: there is no series.
inlined void begin_drag(int lane, const struct lane_drag *d, const double *state, double *inverse_square, double *power) {
    const double *q = d->speed[0] + lane;
    const vector a = get(state, w1), b = get(state, w2), c = get(state, w3), exponent = get(d->power + lane, 0);
    const vector s = a * (get(q, 0) * a + 2 * (get(q, 5) * b + get(q, 4) * c)) + b * (get(q, 1) * b + 2 * get(q, 3) * c)
                     + c * get(q, 2) * c;
    vector y;
    for (int i = 0; i < width; ++i) {
        y[i] = exponent[i] < 0.5 || exponent[i] > 0.5 ? pow(s[i], exponent[i]) : sqrt(s[i]);
    }
    put(inverse_square + lane, 0, 1 / s), put(power + lane, 0, y);
}

#define cross_of(a, b, i) ((a)[((i) + 1) % 3] * (b)[((i) + 2) % 3] - (a)[((i) + 2) % 3] * (b)[((i) + 1) % 3])

// The acceleration of the pivot in space axes, z'' + 2 O x z' + O x (O x z) with z = A cos(W t + f), and its rate over W.
inlined void find_pushes(int lane, const struct lane_constants *e, vector t, const vector o[3], vector now[3],
                         vector later[3]) {
    const vector rate = get(e->rate + lane, 0);
    vector even[3], odd[3], turned[3];
    for_all(i, 3) {
        const vector size = get(e->amplitude[i] + lane, 0);
        find_circle(rate * t + get(e->phase[i] + lane, 0), &even[i], &odd[i]);
        even[i] *= size, odd[i] *= size;
    }
    for_all(i, 3) turned[i] = cross_of(o, even, i) - 2 * rate * odd[i];
    for_all(i, 3) now[i] = cross_of(o, turned, i) - rate * rate * even[i];
    for_all(i, 3) turned[i] = cross_of(o, odd, i) + 2 * rate * even[i];
    for_all(i, 3) later[i] = rate * rate * odd[i] - cross_of(o, turned, i);
}

#undef cross_of

// Term 0 of the further rows, and what all terms need. Space x and y in body axes are X = e - (e.G)/(1 + s G3) (G + s z) with
// e = (cos xi, -sin xi, 0), and Y with e = s (sin xi, cos xi, 0).
inlined void begin_rows(const struct lane_kinds *has, int lane, const struct lane_constants *e, vector t, vector s,
                        const double *c, struct start *of, double *x) {
    const vector g[3] = {get(c, g1), get(c, g2), get(c, g3)}, inverse = 1 / (1 + s * g[2]);
    put(of->inverse + lane, 0, s * inverse);
    for_all(i, 3) {
        put(of->rotor[0][i] + lane, 0, get(e->rotor[0][i] + lane, 0) + t * get(e->drive[0][i] + lane, 0));
        put(of->rotor[1][i] + lane, 0, get(e->rotor[1][i] + lane, 0) + t * get(e->drive[1][i] + lane, 0));
    }
    for_all(d, has->drags) begin_drag(lane, &e->drag[d], c, of->inverse_square[d], of->power[d]);
    if (!(has->turns || has->twists || has->vibrates)) return;

    vector cosine, sine, space[4][3];
    find_circle(get(c, angle), &cosine, &sine);
    const vector along = (g[0] * cosine - g[1] * sine) * inverse, across = s * (g[0] * sine + g[1] * cosine) * inverse;
    const vector first[3] = {cosine - along * g[0], -sine - along * g[1], -along * (g[2] + s)};
    const vector second[3] = {s * sine - across * g[0], s * cosine - across * g[1], -across * (g[2] + s)};
    int turning[most_turning];
    const int n = list_turning(has, turning);
    for_all(i, 3) {
        space[0][i] = get(e->frame_rate[i] + lane, 0);
        space[1][i] = get(e->torque_space[i] + lane, 0);
    }
    if (has->vibrates) find_pushes(lane, e, t, space[0], space[2], space[3]);
    for_all(r, n) {
        const vector *v = space[turning[r] / 3];
        for_all(i, 3) put(x, turning[r] + i, v[0] * first[i] + v[1] * second[i] + v[2] * g[i]);
    }
}
