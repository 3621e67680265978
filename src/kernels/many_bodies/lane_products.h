// Products of power series, one pair in each lane of a vector, see bernstein.f90; and the slope of the squared support
// force, which is made of them, see lane_watch.f90.
//
// Two terms are computed at once, which have most operands in common.

// Series that are multiplied or squared at once.
enum { most_at_once = 3 };

// Room for the terms of a series.
typedef double lane_series[lanes * most_terms] __attribute__((aligned(64)));

// Terms k and k + 1 of the products of a series with each of some; of k = -1, which does not exist, zero.
inlined void find_products(int k, int many, const double *x, const double *const *y, vector *now, vector *next) {
    vector ahead[most_at_once];
    for_all(n, many) now[n] = (vector){0}, ahead[n] = get(y[n], k + 1), next[n] = get(x, k + 1) * get(y[n], 0);
    unrolled_for(int j = 0; j <= k; ++j) {
        const vector factor = get(x, j);
        for_all(n, many) {
            const vector here = get(y[n], k - j);
            now[n] += factor * here, next[n] += factor * ahead[n];
            ahead[n] = here;
        }
    }
}

// Terms k and k + 1, k odd, of the sum of the squares of some series, of which products are equal in pairs. The series end with
// term `last`: behind it there is no next.
inlined void find_squares(int k, int last, int many, const double *const *x, vector *now, vector *next) {
    const int ahead = k < last ? k + 1 : k;
    vector one[most_at_once], other[most_at_once];
    for_all(n, many) one[n] = other[n] = (vector){0};
    unrolled_for(int j = 0; j <= k / 2; ++j) {
        for_all(n, many) {
            const vector factor = get(x[n], j);
            one[n] += factor * get(x[n], k - j), other[n] += factor * get(x[n], ahead - j);
        }
    }
    *now = *next = (vector){0};
    for_all(n, many) {
        const vector middle = get(x[n], ahead / 2);
        *now += 2 * one[n], *next += 2 * other[n] + middle * middle;
    }
}

// The first term.
inlined vector square_of(int many, const double *const *x) {
    vector sum = {0};
    for_all(n, many) sum += get(x[n], 0) * get(x[n], 0);
    return sum;
}

static void multiply_lanes(int degree, const double *x, const double *y, double *product) {
    for (int k = -1 + degree % 2; k <= degree; k += 2) {
        for (int lane = 0; lane < lanes; lane += width) {
            const double *const other = y + lane;
            vector now, next;
            find_products(k, 1, x + lane, &other, &now, &next);
            if (k >= 0) put(product + lane, k, now);
            put(product + lane, k + 1, next);
        }
    }
}

static void square_lanes(int degree, const double *x, double *product) {
    for (int lane = 0; lane < lanes; lane += width) {
        const double *const own = x + lane;
        put(product + lane, 0, square_of(1, &own));
        for (int k = 1; k <= degree; k += 2) {
            vector now, next;
            find_squares(k, degree, 1, &own, &now, &next);
            put(product + lane, k, now);
            if (k < degree) put(product + lane, k + 1, next);
        }
    }
}

// Term k is the sum over i + j = k + 1 of (i - j) x_i y_j, of which each two with i and j the other way round are one.
static void multiply_slopes(int degree, const double *x, const double *y, double *product) {
    for (int k = 0; k <= degree; k += 2) {
        const int ahead = k < degree ? 2 : 1;
        for (int lane = 0; lane < lanes; lane += width) {
            const double *const a = x + lane, *const b = y + lane;
            vector now = {0}, next = now, weight = now + (k + 1);
            unrolled_for(int j = 0; j <= k / 2; ++j) {
                const vector xj = get(a, j), yj = get(b, j);
                now += weight * (get(a, k + 1 - j) * yj - xj * get(b, k + 1 - j));
                next += (weight + 1) * (get(a, k + ahead - j) * yj - xj * get(b, k + ahead - j));
                weight -= 2;
            }
            put(product + lane, k, now);
            if (k < degree) put(product + lane, k + 1, next);
        }
    }
}

// The component of a vector along an axis.
inlined vector inner(const double *axis, const double *x) {
    return get(axis, 0) * get(x, 0) + get(axis, 1) * get(x, 1) + get(axis, 2) * get(x, 2);
}

// The slope over the step as the unit interval, from the powers of its length, so that no term overflows, and the square where
// it begins. `axes` are unit vectors, two beside the centre of mass and one along it, by components; `arm` is its distance.
static void find_force_slopes(int degree, const double *axes, const double *arm, const double *gravity, const double *power,
                              const double *c, double *slope, double *first) {
    const int last = degree + 1;
    lane_series w[3], f[3];

    for (int lane = 0; lane < lanes; lane += width) {
        const vector length = get(arm + lane, 0), weight = get(gravity + lane, 0);
        const double *const axis[] = {axes + lane, axes + 3 * lanes + lane, axes + 6 * lanes + lane};
        const double *const across[] = {w[0] + lane, w[1] + lane}, *const force[] = {f[0] + lane, f[1] + lane, f[2] + lane};
        vector rate[3], now[2], next[2];

        for_all(m, 3) rate[m] = inner(axis[m], c + lane + lanes * w1);
        for (int k = 0; k <= last; ++k) {
            const double *const here = c + term * k + lane;
            const vector scale = get(power + lane, k);
            vector vertical[3], ahead[3];
            for_all(m, 3) {
                vertical[m] = weight * inner(axis[m], here + lanes * g1);
                ahead[m] = inner(axis[m], here + term + lanes * w1);
            }
            put(f[0] + lane, k, scale * (vertical[0] + (k + 1) * length * ahead[1]));
            put(f[1] + lane, k, scale * (vertical[1] - (k + 1) * length * ahead[0]));
            put(f[2] + lane, k, scale * vertical[2]);
            for_all(m, 3) put(w[m] + lane, k, scale * rate[m]), rate[m] = ahead[m];
        }
        for (int k = -1 + last % 2; k <= last; k += 2) {
            find_products(k, 2, w[2] + lane, across, now, next);
            for_all(m, 2) {
                if (k >= 0) put(f[m] + lane, k, get(f[m] + lane, k) + length * now[m]);
                put(f[m] + lane, k + 1, get(f[m] + lane, k + 1) + length * next[m]);
            }
        }
        put(f[2] + lane, 0, get(f[2] + lane, 0) - length * square_of(2, across));
        for (int k = 1; k <= last; k += 2) {
            find_squares(k, last, 2, across, now, next);
            put(f[2] + lane, k, get(f[2] + lane, k) - length * *now);
            if (k < last) put(f[2] + lane, k + 1, get(f[2] + lane, k + 1) - length * *next);
        }
        put(first + lane, 0, square_of(3, force));
        for (int k = 1; k <= last; k += 2) {
            find_squares(k, last, 3, force, now, next);
            put(slope + lane, k - 1, k * *now);
            if (k < last) put(slope + lane, k, (k + 1) * *next);
        }
    }
}
