// The sums of the stages of a Runge-Kutta step with two embedded methods, and what they say of its error; see runge_kutta.f90.
// In C with vectors, as the stages themselves are found: from state to state this would be half of a step.

// Weights of a stage in the change of the state, with the rounding error of that, and in the errors of the embedded methods.
enum { by_change, by_rest, by_fifth, by_third, weights };

static inline double sum_of_all(const double *v) { return ((v[0] + v[4]) + (v[1] + v[5])) + ((v[2] + v[6]) + (v[3] + v[7])); }

static double sum_stages(int since, int stages, const double *weight, const double *k, const double *y, const double *rest,
                         double h, const double *absolute, const double *relative, int states, double most, double share,
                         double *change, double *y_new, double *growth) {
    double squares[2][numbers];
    for (int i = 0; i < numbers; i += width) {
        vector slope = load(k + i);
        vector main = weight[by_change] * slope, lost = weight[by_rest] * slope;
        vector fifth = weight[by_fifth] * slope, third = weight[by_third] * slope;
        for (int j = since - 1; j < stages; ++j) {
            const double *w = weight + weights * j;
            slope = load(k + numbers * j + i);
            main += w[by_change] * slope, lost += w[by_rest] * slope;
            fifth += w[by_fifth] * slope, third += w[by_third] * slope;
        }
        const vector before = load(y + i), step = h * (main + lost), after = before + (step + load(rest + i));
        const vector a = magnitude(before), b = magnitude(after);
        const vector per_error = 1 / (load(absolute + i) + load(relative + i) * where(a < b, b, a));
        fifth *= per_error, third *= per_error;
        fifth *= fifth, third *= third;
        memcpy(change + i, &step, sizeof step), memcpy(y_new + i, &after, sizeof after);
        memcpy(squares[0] + i, &fifth, sizeof fifth), memcpy(squares[1] + i, &third, sizeof third);
    }
    const double fifth = h * h * sum_of_all(squares[0]), both = (fifth + h * h * 0.01 * sum_of_all(squares[1])) * states;
    if (!(fifth <= DBL_MAX && both <= DBL_MAX)) return fifth + both;
    // Of no error: about -500.
    const vector logarithms = binary_logarithm((vector){fifth, both});
    const double error = logarithms[0] - 0.5 * logarithms[1];
    *growth = power_of_two((vector){most - share * error})[0];
    return error;
}
