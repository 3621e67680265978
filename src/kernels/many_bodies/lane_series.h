// Taylor coefficients of many motions, one in each lane of a vector, and of perturbations of them; see
// lane_series.f90, which has the equations. C with vectors, as a Fortran compiler gets
// there only with flags that would hold for all files: the loop over the terms needs its sums in registers,
// and every operand read once.

// Components of a perturbation, as in lane_series.f90, and perturbations that are carried in turn, so that one is computed
// while another waits for its last term.
enum { components = 6, in_turn = 2 };

// The rows of a term of a perturbation: of omega, and the rotation.
enum { d1, d2, d3, r1, r2, r3 };

// Passes over the pairs of terms: in one there is room for all sums of products and their operands where the processor has
// 32 registers, as it has with the widest vectors.
enum { passes = (int)width == (int)lanes ? 1 : 2 };

// A term of the angular acceleration about axis m, from those of the product of the angular velocities about the other axes, of
// the vertical along the next axis and the one before, and of its own angular velocity.
inlined vector rate_of(const struct lane_body *b, int lane, int m, vector product, vector next, vector before, vector own) {
    return get(*b->coupling + lane, m) * product
           + (next * get(*b->pull + lane, m) - before * get(*b->swing + lane, m) - own * get(*b->decay + lane, m));
}

// Finds the term behind `now`, the k-th from `c` on, and the quotient of `now`. The sums of products start with
// the term in the middle, if there is one, and go on to pairs of an older and a newer one; the newest
// pair comes last, as its numbers have just been found. A quotient that is not known yet is zero. Of two passes the first has
// the products along the same axis and those of angular velocities, the last one those along two axes.
inlined void append_term(int k, int lane, const struct lane_body *b, vector inverse, struct share s, double *c) {
    double *now = c + term * k, *next = now + term;
    const double *middle = c + term * (k / 2), *older, *newer;
    vector w12 = {0}, w23 = w12, w31 = w12, n1 = w12, n2 = w12, g3q = w12;
    vector g12 = w12, g21 = w12, g23 = w12, g32 = w12, g31 = w12, g13 = w12;

    put(now, quotient, w12);
    if (k % 2 == 0) {
        const vector v1 = get(middle, w1), v2 = get(middle, w2), v3 = get(middle, w3);
        const vector e1 = get(middle, g1), e2 = get(middle, g2), e3 = get(middle, g3);
        w12 = v1 * v2, w23 = v2 * v3, w31 = v3 * v1;
        g12 = e1 * v2, g21 = e2 * v1, g23 = e2 * v3, g32 = e3 * v2, g31 = e3 * v1, g13 = e1 * v3;
        n1 = e1 * v1, n2 = e2 * v2, g3q = e3 * get(middle, quotient);
        older = middle - term;
    } else {
        older = middle;
    }
    const double *const first = older;
    for_all(pass, passes) {
        const int is_first = pass == 0, is_last = pass + 1 == passes;
        older = first;
        unrolled_for(newer = middle + term; newer <= now; older -= term, newer += term) {
            const vector v1 = get(older, w1), v2 = get(older, w2), v3 = get(older, w3);
            const vector u1 = get(newer, w1), u2 = get(newer, w2), u3 = get(newer, w3);
            if (is_first) w12 += v1 * u2, w23 += v2 * u3, w31 += v3 * u1;
            vector x = get(older, g1);
            if (is_first) n1 += x * u1;
            if (is_last) g12 += x * u2, g13 += x * u3;
            x = get(older, g2);
            if (is_first) n2 += x * u2;
            if (is_last) g21 += x * u1, g23 += x * u3;
            x = get(older, g3);
            if (is_first) g3q += x * get(newer, quotient);
            if (is_last) g32 += x * u2, g31 += x * u1;
            if (is_first) w12 += u1 * v2, w23 += u2 * v3, w31 += u3 * v1;
            x = get(newer, g1);
            if (is_first) n1 += x * v1;
            if (is_last) g12 += x * v2, g13 += x * v3;
            x = get(newer, g2);
            if (is_first) n2 += x * v2;
            if (is_last) g21 += x * v1, g23 += x * v3;
            x = get(newer, g3);
            if (is_first) g3q += x * get(older, quotient);
            if (is_last) g32 += x * v2, g31 += x * v1;
        }
    }

    const vector v1 = get(now, w1), v2 = get(now, w2), v3 = get(now, w3);
    const vector e1 = get(now, g1), e2 = get(now, g2), e3 = get(now, g3);
    const vector n = n1 + n2, q = (n - g3q) * inverse;
    put(now, quotient, q);
    put(now, numerator, n);
    put(next, w1, scaled(rate_of(b, lane, 0, w23, e2, e3, v1), s));
    put(next, w2, scaled(rate_of(b, lane, 1, w31, e3, e1, v2), s));
    put(next, w3, scaled(rate_of(b, lane, 2, w12, e1, e2, v3), s));
    put(next, g1, scaled(g23 - g32, s));
    put(next, g2, scaled(g31 - g13, s));
    put(next, g3, scaled(g12 - g21, s));
    put(next, angle, scaled(v3 + q, s));
}

static void expand_lanes(int order, const struct lane_body *b, const double *side, const double *state, double *c) {
    const int ends[] = {order < exact_shares ? order : exact_shares, order};
    const vector none = {0};
    double inverse[lanes];
    int k = 0;

    for (int lane = 0; lane < lanes; lane += width) {
        const vector s = get(side + lane, 0);
        put(inverse + lane, 0, s / (1 + s * get(state + lane, g3)));
        for (int row = w1; row <= angle; ++row) put(c + lane, row, get(state + lane, row));
        put(c + term * order + lane, quotient, none);
        put(c + term * order + lane, numerator, none);
    }
    // Vectors of lanes in turn: one is computed while another waits for its last term.
    for_all(part, 2) {
        for (; k < ends[part]; ++k) {
            const struct share s = share_of_term(part == 0, k);
            for (int lane = 0; lane < lanes; lane += width) append_term(k, lane, b, get(inverse + lane, 0), s, c + lane);
        }
    }
}

// Finds the term behind the k-th of a perturbation. The products are those of two series of different kind, so that no pair is
// found twice.
inlined void append_tangent(int k, int lane, const struct lane_body *b, const double *c, double *z) {
    vector p1 = {0}, p2 = p1, p3 = p1, e1 = p1, e2 = p1, e3 = p1, t1 = p1, t2 = p1, t3 = p1;
    const double *base = c + term * k, *now = z;
    const double share = 1.0 / (k + 1);
    double *next = z + lanes * components * (k + 1);

    // Few operands at a time, each read once for its products: what has no register would be read again for each.
    unrolled_for(; base >= c; base -= term, now += lanes * components) {
        const vector v1 = get(base, w1), v2 = get(base, w2), v3 = get(base, w3);
        vector x = get(now, d1);
        p3 += x * v2, p2 += x * v3;
        x = get(now, d2);
        p1 += x * v3, p3 += x * v1;
        x = get(now, d3);
        p2 += x * v1, p1 += x * v2;
        const vector y1 = get(now, r1), y2 = get(now, r2), y3 = get(now, r3);
        e3 += y1 * v2, e2 -= y1 * v3;
        e1 += y2 * v3, e3 -= y2 * v1;
        e2 += y3 * v1, e1 -= y3 * v2;
        x = get(base, g1);
        t3 += x * y2, t2 -= x * y3;
        x = get(base, g2);
        t1 += x * y3, t3 -= x * y1;
        x = get(base, g3);
        t2 += x * y1, t1 -= x * y2;
    }
    now = z + lanes * components * k;
    const vector x1 = get(now, d1), x2 = get(now, d2), x3 = get(now, d3);
    p1 = rate_of(b, lane, 0, p1, t2, t3, x1);
    p2 = rate_of(b, lane, 1, p2, t3, t1, x2);
    p3 = rate_of(b, lane, 2, p3, t1, t2, x3);
    put(next, d1, share * p1);
    put(next, d2, share * p2);
    put(next, d3, share * p3);
    put(next, r1, share * (x1 + e1));
    put(next, r2, share * (x2 + e2));
    put(next, r3, share * (x3 + e3));
}

// Sum of the magnitudes of a term; those of omega times `unit`.
inlined vector size_of(const double *z, vector unit) {
    return (magnitude(get(z, d1)) + magnitude(get(z, d2)) + magnitude(get(z, d3))) * unit
           + (magnitude(get(z, r1)) + magnitude(get(z, r2)) + magnitude(get(z, r3)));
}

// The perturbation after the duration, from its series; adds its size, and that of its last terms, to the sums.
inlined void add_tangent(int order, int lane, const double *z, vector h, vector unit, double *after, double *whole,
                         double *last) {
    enum { step = lanes * components };
    const double *newest = z + step * order + lane;
    vector sum[components], power = h;
    for_all(row, components) sum[row] = get(newest, row);
    for (int k = order - 1; k >= 0; --k) {
        for_all(row, components) sum[row] = sum[row] * h + get(z + step * k + lane, row);
    }
    for_all(row, components) put(after + lane, row, sum[row]);
    for (int k = 2; k < order; ++k) power *= h;
    put(whole + lane, 0, get(whole + lane, 0) + size_of(z + lane, unit));
    put(last + lane, 0, get(last + lane, 0) + power * (size_of(newest - step, unit) + h * size_of(newest, unit)));
}

static void carry_tangents(int order, const struct lane_body *b, const double *c, const double *duration, const double *pace,
                           int number, const double *before, double *after, double *whole, double *last) {
    enum { step = lanes * components };
    double z[in_turn][step * most_terms] __attribute__((aligned(64)));

    memset(whole, 0, lanes * sizeof *whole);
    memset(last, 0, lanes * sizeof *last);
    for (int first = 0; first < number; first += in_turn) {
        const int many = number - first < in_turn ? number - first : in_turn;
        for (int v = 0; v < many; ++v) memcpy(z[v], before + step * (first + v), step * sizeof **z);
        for (int k = 0; k < order; ++k) {
            for (int v = 0; v < many; ++v) {
                for (int lane = 0; lane < lanes; lane += width) append_tangent(k, lane, b, c + lane, z[v] + lane);
            }
        }
        for (int lane = 0; lane < lanes; lane += width) {
            const vector h = get(duration + lane, 0), unit = 1 / get(pace + lane, 0);
            for (int v = 0; v < many; ++v) add_tangent(order, lane, z[v], h, unit, after + step * (first + v), whole, last);
        }
    }
}
