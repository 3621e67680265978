// Vectors for the Taylor series of one body (body_series.h): the arrangements of a term, and sums of products
// of terms.

// A term as the factors of its products with other terms (P momentum, G vertical, q quaternion):
//     a0 = (P2 P3 P1 .  G2 G3 G1 .)    b0 = (P3 P1 P2 .  P3 P1 P2 .)
//     a1 = (q3 q3 q1 q2 G3 G1 G2 .)    b1 = (P3 P2 P3 P1 P2 P3 P1 .)
//     a2 = (q1 q0 q0 q0 q2 q2 q3 q1)   b2 = (P1 P1 P2 P3 P2 P3 P1 P2)
struct factors {
    vector a0[parts], b0[parts], a1[parts], b1[parts], a2[parts], b2[parts];
};

// Sums of the three products of two terms.
struct inner_sums {
    vector s0[parts], s1[parts], s2[parts];
};

// Puts (P, G) and q in their arrangements. `torque` are two more, of which the torque of gravity is made:
//     (G2 G3 G1 . G3 G1 G2 .) and (G3 G1 G2 . P2 P3 P1 .).
inlined void arrange(const vector *now, const half_vector *quaternion, struct factors *f, vector torque[2][parts]) {
    const half_vector q = *quaternion;
#if defined(__AVX512F__)
    const vector c = now[0], wide = shuffle(q, q, 0, 1, 2, 3, 0, 1, 2, 3);
    f->a0[0] = shuffle(c, c, 1, 2, 0, 3, 5, 6, 4, 7);
    f->b0[0] = shuffle(c, c, 2, 0, 1, 3, 2, 0, 1, 3);
    torque[0][0] = shuffle(c, c, 5, 6, 4, 7, 6, 4, 5, 7);
    torque[1][0] = shuffle(c, c, 6, 4, 5, 7, 1, 2, 0, 3);
    f->a1[0] = shuffle(wide, c, 3, 3, 1, 2, 14, 12, 13, 15);
    f->b1[0] = shuffle(c, c, 2, 1, 2, 0, 1, 2, 0, 3);
    f->a2[0] = shuffle(wide, wide, 1, 0, 0, 0, 2, 2, 3, 1);
    f->b2[0] = shuffle(c, c, 0, 0, 1, 2, 1, 2, 0, 1);
#elif defined(__AVX__)
    const vector m = now[0], g = now[1];
    f->a0[0] = shuffle(m, m, 1, 2, 0, 3), f->a0[1] = shuffle(g, g, 1, 2, 0, 3);
    f->b0[0] = f->b0[1] = shuffle(m, m, 2, 0, 1, 3);
    f->a1[0] = shuffle(q, q, 3, 3, 1, 2), f->a1[1] = shuffle(g, g, 2, 0, 1, 3);
    f->b1[0] = shuffle(m, m, 2, 1, 2, 0), f->b1[1] = f->a0[0];
    f->a2[0] = shuffle(q, q, 1, 0, 0, 0), f->a2[1] = shuffle(q, q, 2, 2, 3, 1);
    f->b2[0] = shuffle(m, m, 0, 0, 1, 2), f->b2[1] = shuffle(m, m, 1, 2, 0, 1);
    torque[0][0] = f->a0[1], torque[0][1] = f->a1[1];
    torque[1][0] = f->a1[1], torque[1][1] = f->a0[0];
#else
    double c[numbers];
    memcpy(c, now, sizeof c);
#define fill(to, i, j, k, l) ((to)[0] = (vector){i, j}, (to)[1] = (vector){k, l})
    fill(f->a0, c[1], c[2], c[0], 0), fill(f->a0 + 2, c[5], c[6], c[4], 0);
    fill(f->b0, c[2], c[0], c[1], 0), fill(f->b0 + 2, c[2], c[0], c[1], 0);
    fill(f->a1, q[3], q[3], q[1], q[2]), fill(f->a1 + 2, c[6], c[4], c[5], 0);
    fill(f->b1, c[2], c[1], c[2], c[0]), fill(f->b1 + 2, c[1], c[2], c[0], 0);
    fill(f->a2, q[1], q[0], q[0], q[0]), fill(f->a2 + 2, q[2], q[2], q[3], q[1]);
    fill(f->b2, c[0], c[0], c[1], c[2]), fill(f->b2 + 2, c[1], c[2], c[0], c[1]);
#undef fill
    for (int p = 0; p < parts / 2; ++p) {
        torque[0][p] = f->a0[p + 2], torque[0][p + 2] = f->a1[p + 2];
        torque[1][p] = f->a1[p + 2], torque[1][p + 2] = f->a0[p];
    }
#endif
}

// The first four numbers of a row.
inlined half_vector first_half(const vector *v) {
#if defined(__AVX512F__)
    return shuffle(v[0], v[0], 0, 1, 2, 3);
#elif defined(__AVX__)
    return v[0];
#else
    return shuffle(v[0], v[1], 0, 1, 2, 3);
#endif
}

// The last four.
inlined half_vector last_half(const vector *v) {
#if defined(__AVX512F__)
    return shuffle(v[0], v[0], 4, 5, 6, 7);
#else
    return first_half(v + parts / 2);
#endif
}

// A row of two halves.
inlined void from_halves(const half_vector *first, const half_vector *last, vector *to) {
    const half_vector low = *first, high = *last;
#if defined(__AVX512F__)
    to[0] = shuffle(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
#elif defined(__AVX__)
    to[0] = low, to[1] = high;
#else
    to[0] = shuffle(low, low, 0, 1), to[1] = shuffle(low, low, 2, 3);
    to[2] = shuffle(high, high, 0, 1), to[3] = shuffle(high, high, 2, 3);
#endif
}

// The sum of the four pairs of products that make the rate of the quaternion.
inlined half_vector sum_of_halves(const vector *s1, const vector *s2) {
#if defined(__AVX512F__)
    return (first_half(s1) + first_half(s2)) + shuffle(s2[0], s2[0], 4, 5, 6, 7);
#else
    return (first_half(s1) + first_half(s2)) + first_half(s2 + parts / 2);
#endif
}

// Adds the products that belong to the vertical.
inlined void add_last_half(vector *sum, const vector *s1) {
#if defined(__AVX512F__)
    const vector none = {0};
    sum[0] += shuffle(s1[0], none, 8, 8, 8, 8, 4, 5, 6, 7);
#else
    for (int p = parts / 2; p < parts; ++p) sum[p] += s1[p];
#endif
}

// Adds the products of the terms 2 to k - 1 to coefficient k + 1 of the rates. Where k is even, those of the terms 2 to k are
// found for coefficient k + 2 as well, as what is loaded then serves twice; `later` keeps them for the next term.
inlined void add_inner_products(int k, const struct factors *row, vector *s0, vector *s1, vector *s2,
                                struct inner_sums *later) {
    const struct factors *older = row + 2, *newer = row + k;
    if (parts > 2) {
        // There are registers for one sum each.
        for (--newer; older < row + k; ++older, --newer) {
            for_all(p, parts) s0[p] += older->a0[p] * newer->b0[p];
            for_all(p, parts) s1[p] += older->a1[p] * newer->b1[p];
            for_all(p, parts) s2[p] += older->a2[p] * newer->b2[p];
        }
    } else if (k % 2) {
        for_all(p, parts) s0[p] += later->s0[p], s1[p] += later->s1[p], s2[p] += later->s2[p];
    } else {
        struct inner_sums next;
        for_all(p, parts) {
            next.s0[p] = older->a0[p] * newer->b0[p];
            next.s1[p] = older->a1[p] * newer->b1[p], next.s2[p] = older->a2[p] * newer->b2[p];
        }
        while (newer > row + 2) {
            --newer;
            for_all(p, parts) {
                const vector b0 = newer->b0[p], b1 = newer->b1[p], b2 = newer->b2[p];
                s0[p] += older->a0[p] * b0, s1[p] += older->a1[p] * b1, s2[p] += older->a2[p] * b2;
                next.s0[p] += older[1].a0[p] * b0, next.s1[p] += older[1].a1[p] * b1, next.s2[p] += older[1].a2[p] * b2;
            }
            ++older;
        }
        *later = next;
    }
}
