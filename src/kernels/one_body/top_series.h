// Taylor coefficients of the motion of a symmetric top; see space_frame.f90, which has the equations. C with vectors:
// all components of a term are one vector, and the terms stay in registers where there are enough of them.

// The place of the height in a term, by which all are multiplied.
enum { height = 6 };

// The terms, and the height in each; and the factors of a term and of its products in the next but one.
struct top_terms {
    vector term[highest_order + 1][parts];
    double height[highest_order + 1];
    vector linear[parts], weight[parts], start[parts];
};

#if defined(__clang__)
#define unrolled_far_for for
#else
#define unrolled_far_for _Pragma("GCC unroll 16") for
#endif

// Keeps term k, and puts it to the results without its height.
inlined void keep_term(struct top_terms *s, int k, const vector *term, double *c) {
    double *const row = c + numbers * k;
    for_all(p, parts) {
        s->term[k][p] = term[p];
        memcpy(row + width * p, &term[p], sizeof *term);
    }
    s->height[k] = term[height / width][height % width];
    row[height] = 0;
}

// Term k + 2: products of the terms 0 to k, and a factor of term k. The newest terms come last.
inlined void add_top_term(struct top_terms *s, int k, struct share share, double *c) {
    vector sum[parts], more[parts], now[parts], next[parts];
    for_all(p, parts) sum[p] = more[p] = (vector){0};
    unrolled_far_for(int j = k / 2; j > 0; --j)
        for_all(p, parts) sum[p] += s->height[j] * s->term[k - j][p];
    unrolled_far_for(int j = k / 2 + 1; j < k; ++j)
        for_all(p, parts) more[p] += s->height[j] * s->term[k - j][p];
    for_all(p, parts) now[p] = s->weight[p] * scaled(sum[p] + more[p], share);
    for_all(p, parts) now[p] += scaled(s->linear[p], share) * s->term[k][p];
    for_all(p, parts) next[p] = now[p] + s->height[k] * scaled(s->start[p], share);
    keep_term(s, k + 2, next, c);
}

// From the state, whose height counts as zero, its rate, and the second derivative of the height.
static void expand_top(int order, const double *linear, const double *weight, const double *share, const double *share_rest,
                       const double *state, const double *rate, double fall, double *c) {
    struct top_terms s;
    vector term[parts];
    get_parts(s.linear, linear), get_parts(s.weight, weight);
    get_parts(term, state);
    term[height / width][height % width] = 0;
    keep_term(&s, 0, term, c);
    for_all(p, parts) s.start[p] = s.weight[p] * term[p];
    for_all(p, parts) term[p] *= share[0] * s.linear[p];
    term[height / width][height % width] = share[0] * fall;
    keep_term(&s, 2, term, c);
    get_parts(term, rate);
    keep_term(&s, 1, term, c);
#if defined(__AVX__) && !defined(__clang__)
    // Without loops, so that no branch depends on the number of terms but the one that ends.
#define after(k)                 \
    if ((k) + 2 > order) return; \
    add_top_term(&s, k, share_of(share, share_rest, k), c);
    // clang-format off
    after(1) after(2) after(3) after(4) after(5) after(6) after(7) after(8) after(9) after(10) after(11) after(12)
    after(13) after(14) after(15) after(16) after(17) after(18) after(19) after(20) after(21) after(22) after(23)
    after(24) after(25) after(26) after(27) after(28)
    // clang-format on
#undef after
#else
    for (int k = 1; k + 2 <= order; ++k) add_top_term(&s, k, share_of(share, share_rest, k), c);
#endif
}
