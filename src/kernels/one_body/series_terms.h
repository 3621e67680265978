// What a step of Taylor's method does with the terms of a series: it finds its size, and the sum; see taylor.f90. In C
// with vectors, as the terms themselves are found: at low orders this is a quarter of a step.

static inline double larger(double a, double b) { return a > b ? a : b; }

static inline double largest(const double *v) {
    return larger(larger(larger(v[0], v[1]), larger(v[2], v[3])), larger(larger(v[4], v[5]), larger(v[6], v[7])));
}

static double length_of_step(int order, const double *c, const double *absolute, const double *relative, const double *scale,
                             double least, double h) {
    double last[numbers], before[numbers];
    for (int i = 0; i < numbers; i += width) {
        // Near a zero of a component the magnitude one step away is used.
        const vector growth = magnitude(load(c + numbers + i)) * h, usual = load(scale + i);
        const vector more = where(growth < usual, growth, usual);
        const vector share = 1 / (load(absolute + i) + load(relative + i) * (magnitude(load(c + i)) + more));
        const vector by_last = (magnitude(load(c + numbers * order + i)) + least) * share;
        const vector by_before = (magnitude(load(c + numbers * (order - 1) + i)) + least) * share;
        memcpy(last + i, &by_last, sizeof by_last), memcpy(before + i, &by_before, sizeof by_before);
    }
    const double most = largest(last), most_before = largest(before);
    if (!(most <= DBL_MAX && most_before <= DBL_MAX)) return most + most_before;
    const vector both = {most, most_before}, per_order = {1.0 / order, 1.0 / (order - 1)};
    const vector logarithms = binary_logarithm(both) * per_order;
    return power_of_two((vector){-larger(logarithms[0], logarithms[1])})[0];
}

// Horner's rule in four sums, of every fourth term each, as each waits for its last step. The order is 4 at least.
static void add_terms(int order, const double *c, double h, double *change) {
    const int top = order / 4 * 4, rest = order - top;
    const double h2 = h * h, h4 = h2 * h2;
    for (int i = 0; i < numbers; i += width) {
        const vector none = {0};
        const double *term = c + numbers * top + i;
        vector s0 = load(term), s1 = none, s2 = none, s3 = none;
        if (rest > 0) s1 = load(term + numbers);
        if (rest > 1) s2 = load(term + 2 * numbers);
        if (rest > 2) s3 = load(term + 3 * numbers);
        for (int k = top - 4; k >= 0; k -= 4) {
            term -= 4 * numbers;
            if (k > 0) s0 = s0 * h4 + load(term);
            s1 = s1 * h4 + load(term + numbers), s2 = s2 * h4 + load(term + 2 * numbers);
            s3 = s3 * h4 + load(term + 3 * numbers);
        }
        s0 = h * (s1 + h * s2) + h2 * (h * s3 + h2 * s0);
        memcpy(change + i, &s0, sizeof s0);
    }
}

// Horner's rule for all variables at once: the sums are as many as needed for none to wait.
static void add_terms_at(int order, const double *c, const double *h, double *change) {
    for (int i = 0; i < instants; i += width) {
        const vector time = load(h + i);
        vector s[numbers] = {{0}};
        for (int k = order; k > 0; --k) {
            for_all(n, numbers) s[n] = s[n] * time + c[numbers * k + n];
        }
        for_all(n, numbers) {
            s[n] *= time;
            memcpy(change + instants * n + i, &s[n], sizeof s[n]);
        }
    }
}
