// Work of effects over a step of motions in lanes, from their Taylor series; see work_lanes.f90, which has the parts.
//
// The power of an effect is the product of two series, its moment and the angular velocity, and the integral of a product of
// terms i and j over a step of length h is a_i b_j h^(i+j+1)/(i + j + 1). So no product of series is computed: each term of
// the angular velocity, times h^i, enters with the sum of the terms of the moment over i + j + 1.

// Most terms of a series with the zeros that fill up the last block.
enum { block = 4, room = most_terms + block };

// The parts of the work, as in loads.f90.
enum { by_damping, by_friction, by_drag, by_vibration, by_torque, by_rotor, works };

// 1/k, from 1 on.
static const double inverse[room] = {
    1.0 / 1,  1.0 / 2,  1.0 / 3,  1.0 / 4,  1.0 / 5,  1.0 / 6,  1.0 / 7,  1.0 / 8,  1.0 / 9,  1.0 / 10, 1.0 / 11, 1.0 / 12,
    1.0 / 13, 1.0 / 14, 1.0 / 15, 1.0 / 16, 1.0 / 17, 1.0 / 18, 1.0 / 19, 1.0 / 20, 1.0 / 21, 1.0 / 22, 1.0 / 23, 1.0 / 24,
    1.0 / 25, 1.0 / 26, 1.0 / 27, 1.0 / 28, 1.0 / 29, 1.0 / 30, 1.0 / 31, 1.0 / 32, 1.0 / 33, 1.0 / 34, 1.0 / 35,
};

// The terms of a vector, each times the power of the step's length of its order.
typedef vector vector_series[room][3];

// The moment of a part of the work in term k, from its rows.
inlined void find_moment(int part, const struct lane_kinds *has, int k, int lane, const struct lane_work *of, const double *c,
                         const double *x, vector moment[3]) {
    for_all(m, 3) {
        const int left = (m + 1) % 3, right = (m + 2) % 3;
        if (part == by_damping) {
            moment[m] = -get(of->damping[m] + lane, 0) * get(c, w1 + m);
        } else if (part == by_drag) {
            moment[m] = -get(of->linear_drag[m] + lane, 0) * get(c, w1 + m);
            for_all(d, most_drags) {
                if (d < has->drags) moment[m] -= get(of->drag[d][m] + lane, 0) * get(x, drags + of_drag * d + drag_v + m);
            }
        } else if (part == by_vibration) {
            moment[m] = get(of->arm[right] + lane, 0) * get(x, push + left)
                        - get(of->arm[left] + lane, 0) * get(x, push + right);
        } else {
            moment[m] = get(of->per_scale + lane, 0) * get(x, torque + m);
            if (k == 0) moment[m] += get(of->torque[m] + lane, 0);
        }
    }
}

// The integral over the step, but for its length, of the product of two series of so many terms.
inlined vector integral(int terms, vector a[][3], vector b[][3]) {
    vector sum[3] = {{0}};
    for (int i = 0; i < terms; i += block) {
        vector s[block][3] = {{{0}}};
        for (int j = 0; j < terms - i; ++j) {
            for_all(n, block) {
                for_all(m, 3) s[n][m] += inverse[i + n + j] * b[j][m];
            }
        }
        for_all(n, block) {
            for_all(m, 3) sum[m] += a[i + n][m] * s[n][m];
        }
    }
    return sum[0] + sum[1] + sum[2];
}

// The same of a constant moment.
inlined vector linear_work(int terms, vector a[][3], const double *moment) {
    vector sum[3] = {{0}}, work = {0};
    for (int i = 0; i < terms; ++i) {
        for_all(m, 3) sum[m] += inverse[i] * a[i][m];
    }
    for_all(m, 3) work += get(moment, m) * sum[m];
    return work;
}

// The same of the moment of a part of the work.
inlined vector work_of(int part, const struct lane_kinds *has, int terms, const vector *power, vector w[][3], int lane,
                       const struct lane_work *of, const double *c, const double *x) {
    vector_series moment;
    for (int k = 0; k < terms; ++k) {
        find_moment(part, has, k, lane, of, c + term * k + lane, x + more * k + lane, moment[k]);
        for_all(m, 3) moment[k][m] *= power[k];
    }
    return integral(terms, w, moment);
}

// The same of a drag with one coefficient: as v = y u and s = w.u, the power is that times y s.
inlined vector uniform_work(int terms, const vector *power, const double *coefficient, const double *drag) {
    vector y[room], s[room], sum = {0};
    for (int k = 0; k < terms; ++k) {
        y[k] = power[k] * get(drag + more * k, drag_y), s[k] = power[k] * get(drag + more * k, drag_s);
    }
    for (int k = terms; k < terms + block; ++k) y[k] = (vector){0};
    for (int i = 0; i < terms; i += block) {
        vector t[block] = {{0}};
        for (int j = 0; j < terms - i; ++j) {
            for_all(n, block) t[n] += inverse[i + n + j] * s[j];
        }
        for_all(n, block) sum += y[i + n] * t[n];
    }
    return -get(coefficient, 0) * sum;
}

// The same of all drags.
inlined vector drag_work(const struct lane_kinds *has, int terms, const vector *power, vector w[][3], int lane,
                         const struct lane_work *of, const double *c, const double *x) {
    vector sum = {0};
    if (!has->uniform) return work_of(by_drag, has, terms, power, w, lane, of, c, x);
    for (int d = 0; d < has->drags; ++d) {
        sum += uniform_work(terms, power, of->drag[d][0] + lane, x + lane + lanes * (drags + of_drag * d));
    }
    return sum;
}

inlined void add_work(double *done, int part, vector work) { put(done, part, get(done, part) + work); }

static void add_lane_work(int order, const struct lane_kinds *has, const int *acts, const struct lane_work *of,
                          const double *duration, const double *c, const double *x, double *done) {
    for (int lane = 0; lane < lanes; lane += width) {
        const vector h = get(duration + lane, 0), none = {0};
        double *sum = done + lane;
        vector power[room];
        vector_series w;

        power[0] = none + 1;
        for (int k = 1; k < order; ++k) power[k] = power[k - 1] * h;
        for (int k = 0; k < order; ++k) {
            for_all(m, 3) w[k][m] = power[k] * get(c + term * k + lane, w1 + m);
        }
        for (int k = order; k < order + block; ++k) w[k][0] = w[k][1] = w[k][2] = none;
        if (acts[by_damping]) add_work(sum, by_damping, h * work_of(by_damping, has, order, power, w, lane, of, c, x));
        if (acts[by_drag]) add_work(sum, by_drag, h * drag_work(has, order, power, w, lane, of, c, x));
        if (has->vibrates) add_work(sum, by_vibration, h * work_of(by_vibration, has, order, power, w, lane, of, c, x));
        if (has->twists) {
            add_work(sum, by_torque, h * work_of(by_torque, has, order, power, w, lane, of, c, x));
        } else if (acts[by_torque]) {
            add_work(sum, by_torque, h * linear_work(order, w, of->torque[0] + lane));
        }
        if (acts[by_rotor]) {
            for (int k = 0; k < order && has->turns; ++k) {
                for_all(m, 3) w[k][m] += power[k] * get(x + more * k + lane, frame + m);
            }
            add_work(sum, by_rotor, -h * linear_work(order, w, of->drive[0] + lane));
        }
    }
}
