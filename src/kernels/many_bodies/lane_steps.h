// Steps of motions in lanes, each lane for itself: how long they are, and the states in them; see lane_steps.f90.

// Sum of the magnitudes of some rows of a term.
inlined vector size_of_rows(const double *row, int from, int to) {
    vector sum = {0};
    for_all(i, rows) {
        if (i >= from && i <= to) sum += magnitude(get(row, i));
    }
    return sum;
}

// The time at which one of the last two terms of the series reaches the tolerance, in units of what it may be; at most `growth`
// times that of the last step, and stretched to the end if this suffices. `trouble` is 0, or why a lane takes no step: 1 if
// that would be shorter than `shortest` times the time, or if there were `most` steps, 2 if the terms are not finite.
static void choose_durations(int order, double absolute, double relative, double growth, double safety, double stretch,
                             double shortest, int64_t most, const double *c, const double *scale, const double *t,
                             const double *t_end, const int64_t *steps, double *h, double *duration, int64_t *trouble) {
    const double of_attitude = 1 / (absolute + relative), of_last = -1.0 / order, of_before = -1.0 / (order - 1);
    for (int lane = 0; lane < lanes; lane += width) {
        const double *last = c + term * order + lane, *before = last - term;
        const vector fastest = load(scale + lane), old = load(h + lane), left = load(t_end + lane) - load(t + lane);
        // A velocity that passes zero is as large as it was or will be a step away.
        const vector later = size_of_rows(c + term + lane, w1, w3) * old;
        const vector speed = size_of_rows(c + lane, w1, w3) + where(later < fastest, later, fastest);
        const vector of_rate = 1 / (absolute * fastest + relative * speed);
        const vector a = of_rate * size_of_rows(last, w1, w3) + of_attitude * size_of_rows(last, g1, angle);
        const vector b = of_rate * size_of_rows(before, w1, w3) + of_attitude * size_of_rows(before, g1, angle);
        const vector by_last = of_last * binary_logarithm(a), by_before = of_before * binary_logarithm(b);
        const vector wanted = safety * power_of_two(where(by_last < by_before, by_last, by_before));
        const vector next = where(growth * old < wanted, growth * old, wanted);
        put(h + lane, 0, next);
        put(duration + lane, 0, where(stretch * next >= left, left, next));
        const bits is_finite = a + b <= DBL_MAX, is_long = next > shortest * load(t + lane);
        for (int i = 0; i < width; ++i) {
            trouble[lane + i] = !is_finite[i] ? 2 : !is_long[i] || steps[lane + i] >= most;
        }
    }
}

// The changes of the first rows after a time, divided by that, all at once, as each sum waits for its last step.
inlined void sum_rows(int many, int order, const double *c, vector time, vector *x) {
    for_all(row, many) x[row] = get(c + term * order, row);
    for (int k = order - 1; k > 0; --k) {
        for_all(row, many) x[row] = x[row] * time + get(c + term * k, row);
    }
}

inlined void so_many_rows_at(int many, int order, const double *c, const double *t, double *states) {
    for (int lane = 0; lane < lanes; lane += width) {
        const vector time = load(t + lane);
        vector x[angle + 1];
        sum_rows(many, order, c + lane, time, x);
        for_all(row, many) put(states + lane, row, get(c + lane, row) + time * x[row]);
    }
}

static void rows_at(int many, int order, const double *c, const double *t, double *states) {
    if (many > w3 + 1) so_many_rows_at(angle + 1, order, c, t, states);
    else so_many_rows_at(w3 + 1, order, c, t, states);
}

// Adds to the states their change over the steps, summed with compensation (Kahan, Comm. ACM 8, 1965). Lanes whose step has no
// length stay as they are.
static void add_steps(int order, const double *c, const double *duration, const double *t_end, double *t_last, double *t,
                      double *state, double *rest) {
    for (int lane = 0; lane < lanes; lane += width) {
        const vector none = {0}, now = load(t + lane), h = load(duration + lane), end = load(t_end + lane);
        const vector then = where(h >= end - now, end, now + h), exact = then - now;
        vector x[angle + 1];
        sum_rows(angle + 1, order, c + lane, exact, x);
        put(t_last + lane, 0, now), put(t + lane, 0, then);
        for_all(row, angle + 1) {
            const vector old = get(state + lane, row), lost = get(rest + lane, row), change = x[row] * exact + lost;
            const vector new = old + change;
            put(rest + lane, row, where(h > none, change - (new - old), lost));
            put(state + lane, row, where(h > none, new, old));
        }
    }
}
