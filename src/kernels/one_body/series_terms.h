// What a step of Taylor's method does with the terms of a series: it finds its size, and the sum; see taylor.f90. In C
// with vectors, as the terms themselves are found: at low orders this is a quarter of a step.
//
// All variables may have a common denominator D (top_series.h). Its terms are in the place `of_denominator` of those of the
// series, and the first is 1, or 0 where D is not used; without a denominator the place is 0. Then the series that is cut off
// behind the order is that of D times the changes. Its terms are products, of which only the last two are found, for the size
// of the step: the sum of all is that of the terms y_j h^j, each times the sum of those D_i h^i with i + j within the order.

inlined double larger(double a, double b) { return a > b ? a : b; }

inlined double largest(const double *v) {
    return larger(larger(larger(v[0], v[1]), larger(v[2], v[3])), larger(larger(v[4], v[5]), larger(v[6], v[7])));
}

// The last two terms of D times the changes, and of D in its place.
inlined void multiply_last(int order, int of_denominator, const double *c, double *product) {
    const double *d = c + numbers * (order - 2) + of_denominator;
    for (int i = 0; i < numbers; i += width) {
        vector before = {0}, last = load(c + numbers * order + i), more = before, more_last = before;
        int j = 1;
        for (; j + 1 < order; j += 2) {
            const vector y = load(c + numbers * j + i), next = load(c + numbers * (j + 1) + i);
            before += d[-numbers * (j - 1)] * y, last += d[-numbers * (j - 2)] * y;
            more += d[-numbers * j] * next, more_last += d[-numbers * (j - 1)] * next;
        }
        if (j < order) {
            const vector y = load(c + numbers * j + i);
            before += d[-numbers * (j - 1)] * y, last += d[-numbers * (j - 2)] * y;
        }
        store(product + i, before + more), store(product + numbers + i, last + more_last);
    }
    product[of_denominator] = d[numbers], product[numbers + of_denominator] = d[2 * numbers];
}

// The time at which the larger of the last two terms reaches the admissible error.
inlined double length_of_step(int order, int of_denominator, const double *c, const double *absolute, const double *relative,
                              const double *scale, double least, double h) {
    double product[2 * numbers], last[numbers], before[numbers];
    const double *ends = c + numbers * (order - 1);
    if (of_denominator && c[of_denominator] > 0) multiply_last(order, of_denominator, c, product), ends = product;
    for (int i = 0; i < numbers; i += width) {
        // Near a zero of a component the magnitude one step away is used.
        const vector growth = magnitude(load(c + numbers + i)) * h, usual = load(scale + i);
        const vector more = where(growth < usual, growth, usual);
        const vector share = 1 / (load(absolute + i) + load(relative + i) * (magnitude(load(c + i)) + more));
        store(before + i, (magnitude(load(ends + i)) + least) * share);
        store(last + i, (magnitude(load(ends + numbers + i)) + least) * share);
    }
    const double most = largest(last), most_before = largest(before);
    if (!(most <= DBL_MAX && most_before <= DBL_MAX)) return most + most_before;
    const vector both = {most, most_before}, per_order = {1.0 / order, 1.0 / (order - 1)};
    const vector logarithms = binary_logarithm(both) * per_order;
    return power_of_two((vector){-larger(logarithms[0], logarithms[1])})[0];
}

// The sums of D up to each term: 1, the largest number, is added last.
inlined void add_denominator_terms(int order, const double *d, double h, double *sum) {
    const double h2 = h * h;
    double even = 0, odd = 0, power = 1;
    sum[0] = 1;
    for (int k = 1; k <= order; k += 2) {
        odd += power * h * d[numbers * k], power *= h2;
        sum[k] = 1 + (even + odd);
        if (k == order) break;
        even += power * d[numbers * (k + 1)];
        sum[k + 1] = 1 + (even + odd);
    }
}

inlined vector weighed(int order, const double *weight, int k, const double *c) {
    const vector value = load(c + numbers * k);
    return weight ? weight[order - k] * value : value;
}

// Horner's rule in four sums, of every fourth term each, as each waits for its last step; terms may have weights, of which the
// last divides the sum. The order is 4 at least.
inlined void add_weighed(int order, const double *weight, const double *c, double h, double *change) {
    const int top = order / 4 * 4, rest = order - top;
    const double h2 = h * h, h4 = h2 * h2;
    for (int i = 0; i < numbers; i += width) {
        const vector none = {0};
        vector s0 = weighed(order, weight, top, c + i), s1 = none, s2 = none, s3 = none;
        if (rest > 0) s1 = weighed(order, weight, top + 1, c + i);
        if (rest > 1) s2 = weighed(order, weight, top + 2, c + i);
        if (rest > 2) s3 = weighed(order, weight, top + 3, c + i);
        for (int k = top - 4; k >= 0; k -= 4) {
            if (k > 0) s0 = s0 * h4 + weighed(order, weight, k, c + i);
            s1 = s1 * h4 + weighed(order, weight, k + 1, c + i), s2 = s2 * h4 + weighed(order, weight, k + 2, c + i);
            s3 = s3 * h4 + weighed(order, weight, k + 3, c + i);
        }
        s0 = h * (s1 + h * s2) + h2 * (h * s3 + h2 * s0);
        store(change + i, weight ? s0 / weight[order] : s0);
    }
}

static void add_terms(int order, int of_denominator, double turn_rate, const double *c, const double *y, double h,
                      double *change) {
    double sum[most_terms];
    if (!of_denominator) {
        add_weighed(order, 0, c, h, change);
        return;
    }
    const double angle = turn_rate * h / 2, half_sine = sin(angle / 2), sine = 2 * half_sine * cos(angle / 2);
    if (c[of_denominator] > 0) {
        add_denominator_terms(order, c + of_denominator, h, sum);
        add_weighed(order, sum, c, h, change);
    } else {
        add_weighed(order, 0, c, h, change);
    }
    const double first = y[0] + change[0], second = y[1] + change[1], drop = -2 * half_sine * half_sine;
    change[0] += drop * first - sine * second, change[1] += drop * second + sine * first;
    change[of_denominator] = 0;
}

// A step: its size by the last terms, and how far it goes; the state there, with the rounding error of the sum.
static double take_step(int order, int of_denominator, double turn_rate, const double *c, const double *absolute,
                        const double *relative, const double *scale, double least, double last_h, double safety, double growth,
                        double stretch, double t, double t_end, const double *y, const double *rest, double *t_new,
                        double *y_new, double *rest_new) {
    double h = safety * length_of_step(order, of_denominator, c, absolute, relative, scale, least, last_h), change[numbers];
    if (!(h <= DBL_MAX)) return h;
    if (h > growth * last_h) h = growth * last_h;
    *t_new = stretch * h >= t_end - t ? t_end : t + h;
    add_terms(order, of_denominator, turn_rate, c, y, *t_new - t, change);
    for (int i = 0; i < numbers; i += width) {
        const vector before = load(y + i), step = load(change + i) + load(rest + i), after = before + step;
        store(y_new + i, after), store(rest_new + i, step - (after - before));
    }
    return h;
}

// Horner's rule for all variables at once: the sums are as many as needed for none to wait.
static void add_terms_at(int order, int of_denominator, double turn_rate, const double *c, const double *y, const double *h,
                         double *change) {
    if (of_denominator) {
        double each[numbers];
        for_all(i, instants) {
            add_terms(order, of_denominator, turn_rate, c, y, h[i], each);
            for_all(n, numbers) change[instants * n + i] = each[n];
        }
        return;
    }
    for (int i = 0; i < instants; i += width) {
        const vector time = load(h + i);
        vector s[numbers] = {{0}};
        for (int k = order; k > 0; --k) {
            for_all(n, numbers) s[n] = s[n] * time + c[numbers * k + n];
        }
        for_all(n, numbers) {
            s[n] *= time;
            store(change + instants * n + i, s[n]);
        }
    }
}
