// Constants of a body, and the start of a step, for motion_series.h.

// Sets the constants of a body, or of the one in a lane.
static void NAME(set)(const struct body_numbers *b, int lane, struct NAME(constants) * e) {
    const int is_linear = !(b->drag_exponent < 1 || b->drag_exponent > 1);
    const element r[3] = {b->centre[0], b->centre[1], b->centre[2]};
    for (int m = 0; m < 3; ++m) {
        const int next = (m + 1) % 3, last = (m + 2) % 3, i = m * stride + lane;
        const element scale = is_many ? 1 / (element)b->inertia[m] : 1;
        e->per_inertia[i] = 1 / (element)b->inertia[m];
        e->coupling[i] = ((element)b->inertia[next] - b->inertia[last]) * scale;
        e->decay[i] = (b->damping[m] + (element)(is_linear ? b->drag_moment[m] : 0)) * scale;
        e->pull[i] = b->mass * r[last] * scale, e->swing[i] = b->mass * r[next] * scale;
        e->torque[i] = ((element)b->torque_body[m] - b->drive[m]) * scale;
        e->rotor[0][i] = b->rotor[next] * scale, e->rotor[1][i] = b->rotor[last] * scale;
        e->drive[0][i] = b->drive[next] * scale, e->drive[1][i] = b->drive[last] * scale;
        e->frame[m][lane] = b->frame[m], e->torque_space[m][lane] = b->torque_space[m];
        for (int n = 0; n < rates; ++n) e->amplitude[n][m][lane] = b->amplitude[n][m], e->phase[n][m][lane] = b->phase[n][m];
        e->drag[of_moment].moment[i] = b->drag_moment[m] * scale, e->drag[of_force].moment[i] = b->drag_force * scale;
        e->arm[i] = r[m];
#if !is_many
        e->inertia[m] = b->inertia[m], e->momentum[m] = b->drive[m], e->axis[m] = b->axis[m];
#endif
    }
    for (int n = 0; n < rates; ++n) e->rate[n][lane] = b->rate[n];
    e->gravity[lane] = b->gravity;
    e->drag[of_moment].power[lane] = ((element)b->drag_exponent - 1) / 2, e->drag[of_force].power[lane] = 0.5;
#if !is_many
    const element arm_square = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
    num cosine, sine;
    e->force = arm_square > 0 ? b->drag_force / arm_square : 0;
    e->mass = b->mass, e->friction_torque = b->friction_torque, e->friction_arm = b->friction_arm, e->smoothing = b->smoothing;
    if (b->earth_rate < 0 || b->earth_rate > 0) {
        // The rate of the frame itself was rounded from these.
        find_circle(b->latitude, &cosine, &sine);
        e->frame[1][0] = b->earth_rate * cosine, e->frame[2][0] = b->earth_rate * sine;
    }
#endif
}

#define cross_of(a, b, i) ((a)[((i) + 1) % 3] * (b)[((i) + 2) % 3] - (a)[((i) + 2) % 3] * (b)[((i) + 1) % 3])

// A vector in space that swings, and its rate over W, at a time: A cos(W t + f), or for the pivot, where this is the place z,
// its acceleration z'' + 2 O x z' + O x (O x z).
inlined void NAME(find_swings)(int n, int lane, const struct NAME(constants) * e, num t, const num o[3], num now[3],
                               num later[3]) {
    const num rate = load_num(e->rate[n] + lane);
    num even[3], odd[3], turned[3];
    for_all(i, 3) {
        const num phase = rate * t + load_num(e->phase[n][i] + lane);
        find_swing(load_num(e->amplitude[n][i] + lane), phase, &even[i], &odd[i]);
        now[i] = even[i], later[i] = -odd[i];
    }
    if (n != of_pivot) return;
    for_all(i, 3) turned[i] = cross_of(o, even, i) - 2 * rate * odd[i];
    for_all(i, 3) now[i] = cross_of(o, turned, i) - rate * rate * even[i];
    for_all(i, 3) turned[i] = cross_of(o, odd, i) + 2 * rate * even[i];
    for_all(i, 3) later[i] = rate * rate * odd[i] - cross_of(o, turned, i);
}

#undef cross_of

// Term 0 of everything. The rows of the angular velocity, or the momentum, and of the attitude are in the state; `table` has
// the terms of the torque over time.
inlined void NAME(begin)(const struct motion_kinds *has, int lane, const struct NAME(constants) * e, num t, num side,
                         const element *state, const double *table, struct NAME(start) * of, element *c, element *x) {
    const num none = {0}, o[3] = {number(frame[0]), number(frame[1]), number(frame[2])};
    num swings[rates][2][3];
    struct turned_row row[most_turned];
    const int n = list_rows(has, row);
    vec axes[3], frame = {0};

    if (!is_many || has->rotor) {
        for_all(i, 2) store_constant(of->rotor[i] + lane, add(constant(rotor[i]), by(t, constant(drive[i]))));
    }
    if (!is_many || n > 0) find_axes(state, side, axes);
    if (is_many) axes[2] = load_vec(at(NAME(g), 0));
    if (has->push) NAME(find_swings)(of_pivot, lane, e, t, o, swings[of_pivot][0], swings[of_pivot][1]);
    for_all(i, 2) {
        if (!(has->harmonic & (i + 1))) continue;
        NAME(find_swings)
        (of_harmonic_in_space + i, lane, e, t, o, swings[of_harmonic_in_space + i][0], swings[of_harmonic_in_space + i][1]);
    }
    if (has->push == along) {
        for_all(i, 2) store_num(more_at(NAME(swing) + i, 0), swings[of_pivot][i][2]);
    }
    int term = 0, factor = 1;
    for_all(r, n) {
        num v[3] = {none, none, none};
        if (row[r].place == of_frame) {
            for_all(i, 3) v[i] = o[i];
        } else if (row[r].place == of_torque) {
            for_all(i, 3) v[i] = number(torque_space[i]);
        } else if (row[r].rate < rates) {
            const int partner = row[r].partner < 0;
            for_all(i, 3) v[i] = swings[row[r].rate][partner][i];
        } else {
            // Term j of a polynomial is the j-th derivative over j!.
            for_all(i, 3) v[i] = none + factor * table[3 * term + i];
            term = (term + 1) % table_terms, factor = term == 0 ? 1 : factor * term;
        }
        vec value = vec_of(v[0], v[1], v[2]);
        if (row[r].turns) value = add(add(by(v[0], axes[0]), by(v[1], axes[1])), by(v[2], axes[2]));
        if (row[r].role == is_frame) frame = value;
        store_vec(more_at(room * row[r].place, 0), value);
    }
    if (has->frame == along) frame = by(o[2], axes[2]);
#if is_many
    vec w = load_vec(at(NAME(w), 0));
    if (has->frame) store_vec(more_at(room * of_frame, 0), frame), store_vec(more_at(NAME(total), 0), add(w, frame));
    store_num(of->inverse + lane, side / (1 + side * axes[2].z));
#else
    const element *const rotor = of->rotor[0];
    const vec momentum = vec_of(state[4] - rotor[2], state[5] - rotor[0], state[6] - rotor[1]);
    const vec total = mul(constant(per_inertia), momentum), w = sub(total, frame);
    store_vec(more_at(NAME(total), 0), total), store_vec(at(NAME(w), 0), w), store_vec(at(NAME(g), 0), axes[2]);
    store_attitude(at(NAME(attitude), 0), state[0], vec_of(state[1], state[2], state[3]));
    of->exists = 1;
#endif
    for_all(d, most_drags) {
        if (!(has->drags & (d + 1))) continue;
        const vec u = NAME(taken)(d, lane, e, w);
        const num s = sum_of(mul(u, u));
        const num b = number(drag[d].power), inverse = inverse_of(s), y = power_of(s, b);
        const vec v = NAME(given)(d, lane, e, u);
        store_num(of->per_square[d] + lane, power_term(b, (num){0}, inverse)), store_num(of->power[d] + lane, y);
        store_constant(of->v[d] + lane, v), store_constant(of->slope[d] + lane, by(2 + (num){0}, v));
        store_num(of->steep[d] + lane, power_term(b, 1 + (num){0}, b * y * inverse));
    }
}

// All terms up to the order; those from `behind` on are found in turn, so that one is computed while another waits for its
// last.
inlined void NAME(expand)(const struct motion_kinds *has, int joins, int order, const struct NAME(constants) * e,
                          struct NAME(start) * of, const element *share, const element *share_rest, element *c, element *x,
                          element *state) {
    const int few = order < exact_shares ? order : exact_shares;
    for (int k = 0; k < few; ++k) {
        const struct share s = {share[k], share_rest[k], 1};
        for (int lane = 0; lane < stride; lane += at_once)
            NAME(append)(has, joins, k, lane, e, of, s, c + lane, x + lane, state);
    }
    for (int k = few; k < order; ++k) {
        const struct share s = {share[k] + share_rest[k], 0, 0};
        for (int lane = 0; lane < stride; lane += at_once)
            NAME(append)(has, joins, k, lane, e, of, s, c + lane, x + lane, state);
    }
}
